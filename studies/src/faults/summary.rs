//! What many schedules come to, as JSON has it.

use std::{collections::BTreeMap, path::PathBuf};

use serde::Serialize;

use super::{fault::Fault, invariants, results::Results, schedule::Schedule, violation::Violation};

/// A violated invariant.
#[derive(Clone, Debug, Serialize)]
pub struct Found {
    /// Which.
    pub invariant: String,
    /// The first seed.
    pub seed: u64,
    /// When \[ms after the start\].
    pub at_ms: i64,
    /// How.
    pub told: String,
    /// In how many schedules.
    pub schedules: u64,
    /// Faults that are left of the first one.
    pub faults: usize,
    /// File to replay.
    pub file: Option<PathBuf>,
    /// What is left of the first one.
    pub schedule: Schedule,
}

/// What many schedules come to.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Schedules run.
    pub schedules: u64,
    /// In a minute of real time; `null` where they were run in parts.
    pub schedules_per_minute: Option<f64>,
    /// What does not hold.
    pub violations: Vec<Found>,
    /// How often each fault was tried.
    pub faults: BTreeMap<&'static str, u64>,
    /// What was checked.
    pub invariants: Vec<&'static str>,
}

impl Summary {
    /// Of `results`, with what is left of each schedule that failed.
    pub fn new(results: &Results, violations: Vec<Found>) -> Summary {
        let count = |name: &'static str| (name, results.faults.get(name).copied().unwrap_or(0));
        Summary {
            schedules: results.schedules,
            schedules_per_minute: results.per_minute().map(f64::round),
            violations,
            faults: Fault::NAMES.into_iter().map(count).collect(),
            invariants: checked(),
        }
    }
}

/// Names of all invariants.
pub fn checked() -> Vec<&'static str> {
    let step = invariants::all();
    let names = step.iter().map(|own| own.name());
    names.chain(invariants::OF_A_SCHEDULE).collect()
}

impl Found {
    /// A violation, what is left of its schedule, in how many it was seen.
    pub fn new(schedule: Schedule, violation: &Violation, schedules: u64) -> Found {
        Found {
            invariant: violation.invariant.to_string(),
            seed: schedule.seed,
            at_ms: violation.at_ms,
            told: violation.told.clone(),
            schedules,
            faults: schedule.event.len(),
            file: None,
            schedule,
        }
    }
}
