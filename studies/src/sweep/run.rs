//! Runs the trials on every processor.

use std::{
    sync::atomic::{AtomicBool, AtomicUsize, Ordering},
    thread,
};

use ferntast_model::ParameterError;
use ferntast_nodes::config::ConfigError;

use super::{Bench, Row, SweepConfig};

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
    let conditions = config.conditions();
    let next = AtomicUsize::new(0);
    let failed = AtomicBool::new(false);
    let work = || {
        let mut rows = Vec::new();
        while !failed.load(Ordering::Relaxed) {
            let place = next.fetch_add(1, Ordering::Relaxed);
            let Some(condition) = conditions.get(place) else {
                break;
            };
            match bench.run(condition) {
                Ok(outcome) => rows.push((place, Row::new(condition, &outcome))),
                Err(error) => {
                    failed.store(true, Ordering::Relaxed);
                    return Err(error);
                }
            }
            done();
        }
        Ok(rows)
    };
    let workers = thread::available_parallelism().map_or(1, usize::from);
    let mut rows = Vec::with_capacity(conditions.len());
    thread::scope(|scope| {
        let threads: Vec<_> = (1..workers).map(|_| scope.spawn(work)).collect();
        rows.extend(work()?);
        for thread in threads {
            match thread.join() {
                Ok(some) => rows.extend(some?),
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
        Ok::<(), ParameterError>(())
    })?;
    rows.sort_by_key(|(place, _)| *place);
    Ok(rows.into_iter().map(|(_, row)| row).collect())
}
