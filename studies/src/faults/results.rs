//! What became of many schedules.

use std::{borrow::Cow, collections::BTreeMap, time::Duration};

use super::{schedule::Schedule, violation::Violation};

/// What became of many schedules.
#[derive(Clone, Debug, Default)]
pub struct Results {
    /// Schedules run.
    pub schedules: u64,
    /// Real time that took, where they were run in one go.
    pub took: Option<Duration>,
    /// Schedules with a fault of that name.
    pub faults: BTreeMap<&'static str, u64>,
    /// For each invariant that was violated: the first schedule, how, and in how many.
    pub violations: BTreeMap<Cow<'static, str>, (Schedule, Violation, u64)>,
    /// By seed, what each schedule violates that violates something.
    pub violating: BTreeMap<u64, Vec<Violation>>,
}

impl Results {
    /// Schedules in a minute, where that was measured.
    pub fn per_minute(&self) -> Option<f64> {
        let rate = |took: Duration| self.schedules as f64 * 60.0 / took.as_secs_f64().max(1e-9);
        self.took.map(rate)
    }

    pub(super) fn add(&mut self, schedule: &Schedule, violations: Vec<Violation>) {
        self.schedules += 1;
        let mut names: Vec<_> = schedule.event.iter().map(|own| own.fault.name()).collect();
        names.sort_unstable();
        for name in names {
            *self.faults.entry(name).or_insert(0) += 1;
        }
        for violation in &violations {
            self.note(schedule, violation, 1);
        }
        if !violations.is_empty() {
            self.violating.insert(schedule.seed, violations);
        }
    }

    pub(super) fn join(&mut self, other: Results) {
        self.schedules += other.schedules;
        for (name, count) in other.faults {
            *self.faults.entry(name).or_insert(0) += count;
        }
        for (schedule, violation, count) in other.violations.values() {
            self.note(schedule, violation, *count);
        }
        self.violating.extend(other.violating);
    }

    /// The first schedule is the same whatever the number of threads.
    fn note(&mut self, schedule: &Schedule, violation: &Violation, count: u64) {
        let first = self
            .violations
            .entry(violation.invariant.clone())
            .or_insert_with(|| (schedule.clone(), violation.clone(), 0));
        first.2 += count;
        if schedule.seed < first.0.seed {
            (first.0, first.1) = (schedule.clone(), violation.clone());
        }
    }
}
