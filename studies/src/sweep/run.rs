//! Runs the trials on every processor.

use ferntast_model::ParameterError;
use ferntast_nodes::config::ConfigError;

use super::{Bench, Row, SweepConfig};
use crate::parallel;

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

/// Every row of `config`, in the order of its conditions; `done` is called once
/// a trial, from any thread.
///
/// # Errors
///
/// The first value that is out of bounds, an arm that cannot be loaded.
pub fn run(config: &SweepConfig, done: impl Fn() + Sync) -> Result<Vec<Row>, RunError> {
    config.validate()?;
    let bench = Bench::new(config)?;
    let rows = parallel::map(&config.conditions(), |_, condition| {
        let outcome = bench.run(condition)?;
        done();
        Ok::<Row, ParameterError>(Row::new(condition, &outcome))
    });
    Ok(rows?)
}
