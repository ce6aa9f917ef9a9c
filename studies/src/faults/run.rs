//! Runs schedules, one or many.

use std::{
    collections::BTreeMap,
    ops::Range,
    panic::{AssertUnwindSafe, catch_unwind},
    path::Path,
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use ferntast_config::Loaded;
use ferntast_control::{delay::Law, planted::Planted};
use ferntast_nodes::graph::Graph;

use super::{
    draw::draw,
    fault::Fault,
    invariants,
    kit::{Kit, KitError},
    results::Results,
    schedule::{Event, Schedule},
    violation::Violation,
    world::{Looks, World, WorldError},
};
use crate::shard::Shard;

/// One schedule in so many is run twice.
const RUN_TWICE: u64 = 200;

/// What became of a schedule.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// The first violation of each invariant.
    pub violations: Vec<Violation>,
    /// The number that stands for all that was published, where that was asked for.
    pub digest: Option<u64>,
}

/// How a schedule is looked at.
#[derive(Clone, Copy, Default)]
pub struct Look<'a> {
    /// In what detail.
    pub looks: Looks<'a>,
    /// The only invariant that matters: the run ends with its first violation.
    pub only: Option<&'a str>,
}

/// A scenario under all its laws.
pub struct Kits {
    scenario: String,
    kits: BTreeMap<String, Kit>,
    /// The scenario's own law first.
    laws: Vec<&'static str>,
}

impl Kits {
    /// What `loaded`, called `scenario` on the command line, comes to.
    ///
    /// # Errors
    ///
    /// What keeps it from being run under faults.
    pub fn new(graph: &Graph, loaded: &Loaded, scenario: &str) -> Result<Kits, KitError> {
        let mut kits = BTreeMap::new();
        let mut laws = vec![loaded.scenario.law.name()];
        for law in Law::NAMES {
            kits.insert((*law).to_owned(), Kit::new(graph, loaded, law)?);
            if !laws.contains(law) {
                laws.push(law);
            }
        }
        Ok(Kits {
            scenario: scenario.to_owned(),
            kits,
            laws,
        })
    }

    /// The schedule of `seed`.
    pub fn draw(&self, seed: u64) -> Schedule {
        draw(seed, &self.scenario, &self.laws)
    }

    /// Runs a schedule.
    ///
    /// # Errors
    ///
    /// A law that there is not, a node that cannot be made.
    pub fn run(&self, schedule: &Schedule, look: Look) -> Result<Outcome, RunError> {
        let kit = self.kits.get(&schedule.law).ok_or_else(|| RunError::Law {
            law: schedule.law.clone(),
        })?;
        let planted = match &schedule.planted {
            None => Planted::NONE,
            Some(name) => {
                Planted::named(name).ok_or_else(|| RunError::Planted { rule: name.clone() })?
            }
        };
        match catch_unwind(AssertUnwindSafe(|| run(kit, schedule, planted, look))) {
            Ok(result) => Ok(result?),
            Err(_) => Ok(Outcome {
                violations: vec![Violation {
                    invariant: "no_panic".into(),
                    at_ms: schedule.length_ms,
                    told: "a node panicked; its message is on stderr".to_owned(),
                }],
                digest: None,
            }),
        }
    }
}

/// Why a schedule cannot be run.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// There is no such law.
    #[error("there is no delay law {law:?}; there are: {}", Law::NAMES.join(", "))]
    Law {
        /// What was asked for.
        law: String,
    },
    /// There is no such rule, or this build has them all.
    #[error(
        "planted = {rule:?}: no rule of that name can be taken out here; only builds with the feature \
         `planted_bugs` can, and control/src/planted.rs lists them"
    )]
    Planted {
        /// What was asked for.
        rule: String,
    },
    /// It cannot be put together.
    #[error(transparent)]
    World(#[from] WorldError),
}

fn run(
    kit: &Kit,
    schedule: &Schedule,
    planted: Planted,
    look: Look,
) -> Result<Outcome, WorldError> {
    let session = kit.session(schedule.seed, planted);
    let second = |event: &Event| matches!(event.fault, Fault::SecondMaster { .. });
    let other = schedule.event.iter().any(second);
    let other = other.then(|| kit.other_operator(schedule.seed));
    let mut world = World::new(kit, &session, other.as_ref(), schedule, look.looks)?;
    let mut checks = invariants::all();
    if let Some(only) = look.only {
        checks.retain(|own| own.name() == only);
    }
    let mut outcome = Outcome::default();
    for _ in 0..schedule.length_ms {
        world.step()?;
        let seen = &world.seen;
        checks.retain_mut(|own| match own.step(seen, &world.log, &kit.facts) {
            None => true,
            Some(told) => {
                outcome.violations.push(Violation {
                    invariant: own.name().into(),
                    at_ms: seen.tick,
                    told,
                });
                false
            }
        });
        if look.only.is_some() && !outcome.violations.is_empty() && look.looks.record.is_none() {
            break;
        }
    }
    let (digest, lost) = world.finish()?;
    outcome.digest = digest;
    if let Some(told) = lost {
        outcome.violations.push(Violation {
            invariant: "nothing_recorded_lost".into(),
            at_ms: schedule.length_ms,
            told,
        });
    }
    Ok(outcome)
}

/// Which schedules, and for how long.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Seeds.
    pub seeds: Range<u64>,
    /// Which of them.
    pub shard: Shard,
    /// Ends after this time.
    pub longest: Option<Duration>,
    /// At the same time.
    pub threads: usize,
}

/// Runs the schedules of `plan`. `change` may change a schedule before it is run;
/// `done` is called after each, from any thread; `stop` ends it early.
///
/// # Errors
///
/// The first schedule that cannot be run.
pub fn run_many(
    kits: &Kits,
    plan: &Plan,
    change: impl Fn(&mut Schedule) + Sync,
    done: impl Fn(&Schedule, &Outcome) + Sync,
    stop: &AtomicBool,
) -> Result<Results, RunError> {
    let begun = Instant::now();
    let next = AtomicU64::new(plan.seeds.start);
    let failed = AtomicBool::new(false);
    let all = Mutex::new(Results::default());
    let work = || {
        let mut own = Results::default();
        loop {
            let over = plan
                .longest
                .is_some_and(|longest| begun.elapsed() >= longest);
            if over || stop.load(Ordering::Relaxed) || failed.load(Ordering::Relaxed) {
                break;
            }
            let seed = next.fetch_add(1, Ordering::Relaxed);
            if seed >= plan.seeds.end {
                break;
            }
            if !plan.shard.takes(seed - plan.seeds.start) {
                continue;
            }
            let mut schedule = kits.draw(seed);
            change(&mut schedule);
            match run_and_compare(kits, &schedule, seed.is_multiple_of(RUN_TWICE)) {
                Ok(outcome) => {
                    done(&schedule, &outcome);
                    own.add(&schedule, outcome.violations);
                }
                Err(error) => {
                    failed.store(true, Ordering::Relaxed);
                    return Err(error);
                }
            }
        }
        all.lock().unwrap_or_else(PoisonError::into_inner).join(own);
        Ok(())
    };
    thread::scope(|scope| {
        let threads: Vec<_> = (1..plan.threads).map(|_| scope.spawn(work)).collect();
        work()?;
        for thread in threads {
            match thread.join() {
                Ok(result) => result?,
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
        Ok::<(), RunError>(())
    })?;
    let mut all = all.into_inner().unwrap_or_else(PoisonError::into_inner);
    all.took = Some(begun.elapsed());
    Ok(all)
}

/// Runs a schedule, and if it is to be run `twice` compares all that was published.
fn run_and_compare(kits: &Kits, schedule: &Schedule, twice: bool) -> Result<Outcome, RunError> {
    let look = Look {
        looks: Looks {
            digest: twice,
            record: None,
        },
        only: None,
    };
    let mut outcome = kits.run(schedule, look)?;
    if twice {
        let again = kits.run(schedule, look)?;
        if again.digest != outcome.digest {
            outcome.violations.push(Violation {
                invariant: "same_seed_same_bytes".into(),
                at_ms: schedule.length_ms,
                told: "two runs of the same schedule published other bytes".to_owned(),
            });
        }
    }
    Ok(outcome)
}

/// Runs a schedule once more and writes a recording of it.
///
/// # Errors
///
/// It cannot be run, the recording cannot be written.
pub fn replay(kits: &Kits, schedule: &Schedule, record: &Path) -> Result<Outcome, RunError> {
    let looks = Looks {
        digest: false,
        record: Some(record),
    };
    kits.run(schedule, Look { looks, only: None })
}
