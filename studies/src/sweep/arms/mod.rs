//! Arms out of URDFs on walls, behind a relay satellite and without delay.
//!
//! Trials as in any sweep, with servo and estimator as an arm's file has them; a plant of its own
//! is stepped in the same virtual time, so that a run is as repeatable as the plant is. Energy,
//! tip and force on it are those of the plant. Both tasks of a wall together take a minute.

mod driven;
mod plant;
mod row;
mod table;

use std::sync::atomic::{AtomicBool, Ordering};

use ferntast_config::{ConfigError, stiff_enough};
use ferntast_control::delay::{Law, Mapping};
use ferntast_drivers::{Choice, UnknownDriver};
use ferntast_model::ParameterError;
use ferntast_nodes::process::NodeError;
use ferntast_sim::teleoperation::{Environment, Outcome, Task, Trial};

use super::{Condition, Row, SweepConfig, config::BUFFER_PER_JITTER};
use crate::parallel;
use driven::{ArmOfSweep, DrivenArm};

pub use row::{ArmRow, Miss};
pub use table::arms_table;

/// Round trip \[ms\], standard deviation of the delay each way \[ms\] and share of frames lost.
const RELAY: (f64, f64, f64) = (600.0, 50.0, 0.1);
/// What an operator does at each wall.
const TASKS: [Task; 2] = [Task::PressAndSlide, Task::Tap];

/// Why there is no table.
#[derive(Debug, thiserror::Error)]
pub enum ArmsError {
    /// A value is out of bounds.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// An arm cannot be loaded.
    #[error(transparent)]
    Arm(#[from] ConfigError),
    /// An arm in a plane.
    #[error("--arms {0}: it is no arm out of a URDF; without --arms the sweep is of it")]
    Planar(String),
    /// A plant does not begin.
    #[error(transparent)]
    Begin(#[from] NodeError),
    /// A plant went away on the way.
    #[error("{0}")]
    Plant(String),
    /// A plant that does not say what is true cannot be judged.
    #[error(
        "the plant tells no truth: contact_force, tip and contact_work have to be in its answer \
         (docs/process_driver.md)"
    )]
    NoTruth,
    /// A driver that there is not.
    #[error(transparent)]
    Driver(#[from] UnknownDriver),
    /// An arm whose time is not the trial's.
    #[error("a sweep runs in virtual time: give --driver simulated or process:COMMAND")]
    RealTime,
    /// The user.
    #[error("stopped")]
    Stopped,
}

/// A trial.
struct Job<'a> {
    arm: &'a ArmOfSweep,
    condition: Condition,
}

/// How many trials [`arms`] makes of that many arms.
pub fn trials(config: &SweepConfig, arms: usize) -> u64 {
    (2 * arms * config.laws.len() * Environment::WALLS.len() * TASKS.len()) as u64
}

/// Every arm of `names`, with `driver` as after `--driver`, on every wall with each law of
/// `config`, and its hand and master; `done` is called once a trial, from any thread, and `stop` ends it.
///
/// # Errors
///
/// [`ArmsError`]: an arm or plant that cannot be used.
pub fn arms(
    config: &SweepConfig,
    names: &[String],
    driver: &str,
    stop: &AtomicBool,
    done: impl Fn() + Sync,
) -> Result<Vec<ArmRow>, ArmsError> {
    config.validate()?;
    let choice: Choice = driver.parse()?;
    let arms = names.iter().map(|name| ArmOfSweep::load(name));
    let arms: Vec<ArmOfSweep> = arms.collect::<Result<_, _>>()?;
    let jobs: Vec<Job<'_>> = arms.iter().flat_map(|arm| jobs(config, arm)).collect();
    let rows = parallel::map(&jobs, |_, job| {
        if stop.load(Ordering::Relaxed) {
            return Err(ArmsError::Stopped);
        }
        let (duration, outcome) = run(config, job, &choice)?;
        done();
        Ok((duration, Row::new(&job.condition, &outcome)))
    })?;
    let pairs = jobs.iter().zip(rows).collect::<Vec<_>>();
    let pairs = pairs.as_chunks::<2>().0.iter();
    Ok(pairs
        .map(|[(_, (_, ideal)), (job, (duration, own))]| {
            ArmRow::new(
                job.arm,
                driver.to_owned(),
                *duration,
                own.clone(),
                ideal.clone(),
            )
        })
        .collect())
}

/// The trials of an arm: each without delay, then over the link.
fn jobs<'a>(config: &SweepConfig, arm: &'a ArmOfSweep) -> Vec<Job<'a>> {
    let seed = config.seeds.first().copied().unwrap_or(1);
    let mut jobs = Vec::new();
    for law in &config.laws {
        for environment in Environment::WALLS {
            for task in TASKS {
                for (rtt_ms, jitter_ms, loss) in [(0.0, 0.0, 0.0), RELAY] {
                    let condition = Condition {
                        law: law.clone(),
                        rtt_ms,
                        jitter_ms,
                        buffer_ms: BUFFER_PER_JITTER * jitter_ms,
                        loss,
                        environment,
                        task,
                        seed,
                    };
                    jobs.push(Job { arm, condition });
                }
            }
        }
    }
    jobs
}

fn run(config: &SweepConfig, job: &Job<'_>, driver: &Choice) -> Result<(f64, Outcome), ArmsError> {
    let Job { arm, condition } = job;
    let trial = |law: Law| Trial {
        hand: config.hand,
        master: Some(config.master.clone()),
        task: condition.task,
        buffer: 1e-3 * condition.buffer_ms,
        deadband: config.codec.of(config.deadband),
        ..Trial::new(law, condition.link(), condition.environment, condition.seed)
    };
    let start = trial(condition.law.clone()).start();
    let origin = arm.origin(start);
    let law = condition.law.between(&Mapping {
        workspace_offset: origin,
        ..condition.law.mapping()
    });
    let law = match arm.stiffness {
        Some(least) => stiff_enough(&law, least),
        None => law,
    };
    let trial = trial(law);
    let (mut driven, servo) =
        DrivenArm::new(arm, driver, condition.environment, origin, condition.seed)?;
    let outcome = trial.run_on(&mut driven, servo)?;
    match driven.failure() {
        Some(reason) => Err(ArmsError::Plant(format!("{}: {reason}", arm.name))),
        None => Ok((trial.duration(), outcome)),
    }
}
