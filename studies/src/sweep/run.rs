//! Runs the trials on every processor.

use std::sync::atomic::AtomicBool;

use ferntast_config::ConfigError;
use ferntast_model::ParameterError;

use super::{Bench, Row, SweepConfig};
use crate::{
    parallel,
    shard::{Placed, Shard, Study},
};

/// Why there are no rows.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// A value is out of bounds.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The arm cannot be loaded.
    #[error(transparent)]
    Arm(#[from] ConfigError),
}

impl Study for SweepConfig {
    const KIND: &'static str = "sweep";
    type Answer = Row;
}

/// The rows of `config` that are in `shard`, in the order of its conditions, until `stop`;
/// `done` is called once a trial, from any thread.
///
/// # Errors
///
/// The first value that is out of bounds, an arm that cannot be loaded.
pub fn run(
    config: &SweepConfig,
    shard: Shard,
    stop: &AtomicBool,
    done: impl Fn() + Sync,
) -> Result<Vec<Placed<Row>>, RunError> {
    config.validate()?;
    let bench = Bench::new(config)?;
    let conditions = shard.part_of(config.conditions());
    let rows = parallel::map_until(&conditions, stop, |_, (place, condition)| {
        let outcome = bench.run(condition)?;
        done();
        Ok::<_, ParameterError>(Placed {
            place: *place,
            value: Row::new(condition, &outcome),
        })
    })?;
    Ok(rows.into_iter().map(|(_, row)| row).collect())
}
