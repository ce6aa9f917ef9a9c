//! Many schedules, as they can be run in parts.

use std::{collections::BTreeMap, ops::Range};

use serde::{Deserialize, Serialize};

use super::{results::Results, run::Kits, schedule::Schedule, violation::Violation};
use crate::shard::{Placed, Study};

/// Schedules by their seeds, as they can be run in parts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FaultStudy {
    /// The scenario, shipped or a file.
    pub scenario: String,
    /// Seeds.
    pub seeds: Range<u64>,
    /// Faults that are left out, by name.
    pub without: Vec<String>,
}

impl Study for FaultStudy {
    const KIND: &'static str = "faults";
    /// What a schedule violates; those that violate nothing are left out.
    type Answer = Vec<Violation>;
}

impl FaultStudy {
    /// Leaves out of `schedule` what is left out.
    pub fn change(&self, schedule: &mut Schedule) {
        let left_out = |name: &str| self.without.iter().any(|own| own == name);
        schedule.event.retain(|own| !left_out(own.fault.name()));
    }

    /// What the answers of all parts come to, by the schedules of `kits`.
    pub fn total(&self, kits: &Kits, answers: Vec<Placed<Vec<Violation>>>) -> Results {
        let mut answers: BTreeMap<u64, Vec<Violation>> = answers
            .into_iter()
            .map(|own| (own.place, own.value))
            .collect();
        let mut results = Results::default();
        for (place, seed) in (0..).zip(self.seeds.clone()) {
            let mut schedule = kits.draw(seed);
            self.change(&mut schedule);
            results.add(&schedule, answers.remove(&place).unwrap_or_default());
        }
        results
    }

    /// What of `results` a part has to say.
    pub fn answers(&self, results: Results) -> Vec<Placed<Vec<Violation>>> {
        let placed = |(seed, value)| Placed {
            place: seed - self.seeds.start,
            value,
        };
        results.violating.into_iter().map(placed).collect()
    }
}
