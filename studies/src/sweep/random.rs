//! Cases drawn at random: scales, channels, hands, surfaces and tasks, from seeds.

use std::{fmt::Write, sync::atomic::AtomicBool};

use ferntast_model::ParameterError;
use serde::{Deserialize, Serialize};

use super::{Bench, RunError, SweepConfig};
use crate::{
    parallel,
    shard::{Placed, Shard, Study},
};

/// A law that makes more at hand and tip is not passive \[J\].
pub const BOUND: f64 = 0.02;
/// Seeds that are told, the worst first.
const TOLD: usize = 10;

/// What came of the cases of one law.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RandomCases {
    /// The law.
    pub law: &'static str,
    /// Whether it claims that there is no case beyond.
    pub claims_passivity: bool,
    /// Cases that were run; fewer than asked for where they were stopped.
    pub cases: u64,
    /// Least of energy entered less energy left at hand and tip, in any of them \[J\]; `null`
    /// where it is no number.
    #[serde(rename = "worst_energy_J")]
    pub worst_energy: f64,
    /// Cases that made more than 0.02 J.
    pub beyond: u64,
    /// Their share \[-\].
    pub share_beyond: f64,
    /// Share of the cases in which the task was done in time \[-\].
    pub share_done: f64,
    /// Seeds of the worst of those beyond, and how much each made \[J\].
    pub worst: Vec<Worst>,
}

/// What came of a case.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Case {
    /// Whence it all comes.
    pub seed: u64,
    /// As in [`RandomCases::worst_energy`].
    #[serde(rename = "true_energy_J")]
    pub energy: f64,
    /// The task was done in time.
    pub done: bool,
}

/// A case that is told.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Worst {
    /// Whence it all comes.
    pub seed: u64,
    /// As in [`RandomCases::worst_energy`].
    #[serde(rename = "true_energy_J")]
    pub energy: f64,
}

impl Case {
    fn is_beyond(&self) -> bool {
        self.energy < -BOUND || self.energy.is_nan()
    }
}

impl RandomCases {
    fn new(law: &'static str, claims_passivity: bool, mut cases: Vec<Case>) -> RandomCases {
        let count = cases.len() as f64;
        let share = |own: usize| if count > 0.0 { own as f64 / count } else { 0.0 };
        let size = |own: &Case| {
            if own.energy.is_nan() {
                f64::NEG_INFINITY
            } else {
                own.energy
            }
        };
        cases.sort_by(|a, b| size(a).total_cmp(&size(b)).then(a.seed.cmp(&b.seed)));
        let beyond = cases.iter().filter(|own| own.is_beyond()).count();
        RandomCases {
            law,
            claims_passivity,
            cases: cases.len() as u64,
            worst_energy: cases.first().map_or(0.0, |own| own.energy),
            beyond: beyond as u64,
            share_beyond: share(beyond),
            share_done: share(cases.iter().filter(|own| own.done).count()),
            worst: cases
                .iter()
                .take(beyond.min(TOLD))
                .map(|own| Worst {
                    seed: own.seed,
                    energy: own.energy,
                })
                .collect(),
        }
    }

    /// Whether the law claims what it does not keep.
    pub fn breaks_its_claim(&self) -> bool {
        self.claims_passivity && self.beyond > 0
    }
}

/// Cases of each law of a sweep, drawn from seeds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RandomSweep {
    /// Seed of the first case.
    pub seed: u64,
    /// Cases of each law.
    pub cases: u64,
    /// The laws, and all that is not drawn.
    pub sweep: SweepConfig,
}

impl Study for RandomSweep {
    const KIND: &'static str = "random_sweep";
    type Answer = Case;
}

impl RandomSweep {
    /// Cases in all.
    pub fn count(&self) -> u64 {
        self.cases.saturating_mul(self.sweep.laws.len() as u64)
    }

    /// The law, by its place, and the seed of the case at `place`: seed by seed.
    fn case(&self, place: u64) -> (usize, u64) {
        let laws = self.sweep.laws.len() as u64;
        let seed = self.seed.saturating_add(place / laws);
        ((place % laws) as usize, seed)
    }

    /// Runs the cases that are in `shard`, on every processor, until `stop`; `done` is called
    /// once a case, from any thread.
    ///
    /// # Errors
    ///
    /// The first value that is out of bounds, an arm that cannot be loaded.
    pub fn run(
        &self,
        shard: Shard,
        stop: &AtomicBool,
        done: impl Fn() + Sync,
    ) -> Result<Vec<Placed<Case>>, RunError> {
        self.sweep.validate()?;
        let bench = Bench::new(&self.sweep)?;
        let places: Vec<u64> = (0..self.count()).filter(|own| shard.takes(*own)).collect();
        let cases = parallel::map_until(&places, stop, |_, &place| {
            let (law, seed) = self.case(place);
            let outcome = bench.drawn(&self.sweep.laws[law], seed).run()?;
            done();
            Ok::<_, ParameterError>(Placed {
                place,
                value: Case {
                    seed,
                    energy: outcome.energy_margin,
                    done: outcome.task_time.is_some(),
                },
            })
        })?;
        Ok(cases.into_iter().map(|(_, case)| case).collect())
    }

    /// What the cases come to, law by law.
    pub fn total(&self, cases: &[Placed<Case>]) -> Vec<RandomCases> {
        let of = |law: usize| {
            let own = cases
                .iter()
                .filter(move |own| self.case(own.place).0 == law);
            own.map(|own| own.value).collect()
        };
        let laws = self.sweep.laws.iter().enumerate();
        laws.map(|(place, law)| RandomCases::new(law.name(), law.claims_passivity(), of(place)))
            .collect()
    }
}

/// A line a law, for a terminal.
pub fn random_table(laws: &[RandomCases]) -> String {
    let mut text = format!(
        "{:20} {:>8} {:>11} {:>14} {:>9} {:>9}  worst seeds",
        "law", "cases", "worst [J]", "beyond 0.02 J", "share", "done"
    );
    for own in laws {
        let seeds: Vec<String> = own
            .worst
            .iter()
            .take(3)
            .map(|case| case.seed.to_string())
            .collect();
        // Writing into a string does not fail.
        let _ = write!(
            text,
            "\n{:20} {:>8} {:>11.4} {:>14} {:>7.2} % {:>7.1} %  {}",
            own.law,
            own.cases,
            own.worst_energy,
            own.beyond,
            1e2 * own.share_beyond,
            1e2 * own.share_done,
            seeds.join(", ")
        );
    }
    text
}
