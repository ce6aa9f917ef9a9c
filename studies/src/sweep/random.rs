//! Cases drawn at random: scales, channels, hands, surfaces and tasks, from seeds.

use std::{
    fmt::Write,
    sync::atomic::{AtomicBool, AtomicU64, Ordering},
    thread,
};

use ferntast_model::ParameterError;
use serde::Serialize;

use super::{Bench, RunError, SweepConfig};

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
    pub worst: Vec<Case>,
}

/// A case.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Case {
    /// Whence it all comes.
    pub seed: u64,
    /// As in [`RandomCases::worst_energy`].
    #[serde(rename = "true_energy_J")]
    pub energy: f64,
    /// The task was done in time.
    #[serde(skip)]
    pub done: bool,
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
            worst: cases.iter().take(beyond.min(TOLD)).copied().collect(),
        }
    }

    /// Whether the law claims what it does not keep.
    pub fn breaks_its_claim(&self) -> bool {
        self.claims_passivity && self.beyond > 0
    }
}

/// Runs `count` cases of each law of `config`, from `first_seed` on, seed by seed on every
/// processor, until `stop`; `done` is called once a case, from any thread.
///
/// # Errors
///
/// The first value that is out of bounds, an arm that cannot be loaded.
pub fn random(
    config: &SweepConfig,
    first_seed: u64,
    count: u64,
    stop: &AtomicBool,
    done: impl Fn() + Sync,
) -> Result<Vec<RandomCases>, RunError> {
    config.validate()?;
    let bench = Bench::new(config)?;
    let laws = config.laws.len() as u64;
    let next = AtomicU64::new(0);
    let failed = AtomicBool::new(false);
    let work = || {
        let mut cases = Vec::new();
        while !stop.load(Ordering::Relaxed) && !failed.load(Ordering::Relaxed) {
            let place = next.fetch_add(1, Ordering::Relaxed);
            let (law, seed) = (
                (place % laws) as usize,
                first_seed.saturating_add(place / laws),
            );
            let Some(parameters) = config.laws.get(law).filter(|_| place / laws < count) else {
                break;
            };
            match bench.drawn(parameters, seed).run() {
                Ok(outcome) => cases.push((
                    law,
                    Case {
                        seed,
                        energy: outcome.energy_margin,
                        done: outcome.task_time.is_some(),
                    },
                )),
                Err(error) => {
                    failed.store(true, Ordering::Relaxed);
                    return Err(error);
                }
            }
            done();
        }
        Ok(cases)
    };
    let workers = thread::available_parallelism().map_or(1, usize::from);
    let mut cases = Vec::new();
    thread::scope(|scope| {
        let threads: Vec<_> = (1..workers).map(|_| scope.spawn(work)).collect();
        cases.extend(work()?);
        for thread in threads {
            match thread.join() {
                Ok(some) => cases.extend(some?),
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
        Ok::<(), ParameterError>(())
    })?;
    let of = |law: usize| {
        cases
            .iter()
            .filter(move |own| own.0 == law)
            .map(|own| own.1)
    };
    let each = config.laws.iter().enumerate();
    Ok(each
        .map(|(place, law)| {
            RandomCases::new(law.name(), law.claims_passivity(), of(place).collect())
        })
        .collect())
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
