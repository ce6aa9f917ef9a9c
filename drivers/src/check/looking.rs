//! Looks at an arm, or moves it, in real time: the loops around what is judged.

use std::sync::atomic::{AtomicBool, Ordering};

use ferntast_control::LONGEST_STEP;
use ferntast_model::{JointCount, Joints};
use ferntast_msgs::{Text, Time, sample::Level};
use ferntast_nodes::{
    graph::STEP_NANOS,
    node::NodeHealth,
    process::{Clock, NodeError, Priority, SessionContext, periodic},
};

use super::{
    mover::{Moved, Mover, Progress},
    record::{Record, Seen},
};
use crate::{
    choice::Choice,
    driver::{Driver, DriverCommand, Reading},
    weight::Weight,
};

/// A driver that is not homed is given so long to come to that \[s\].
const HOMING: f64 = 5.0;
/// Damping with which a simulated arm is carried \[Nm·s/rad\].
const CARRY_DAMPING: f64 = 5.0;

/// An arm without a session.
struct Bench {
    driver: Box<dyn Driver>,
    clock: Clock,
    record: Record,
    enabled: bool,
    last: Option<Time>,
    last_reading: Option<Reading>,
    /// Time that counts, without what the loop was held up for \[s\].
    passed: f64,
    /// How much of it before the first reading.
    before: Option<f64>,
}

impl Bench {
    fn new(session: &SessionContext) -> Result<Bench, NodeError> {
        // Where that is not allowed it goes on without: what it is held up for is left out.
        let _ = Priority::Arm.take();
        Ok(Bench {
            driver: Choice::of(session)?.driver(session, false)?,
            clock: session.clock(),
            record: Record::default(),
            enabled: false,
            last: None,
            last_reading: None,
            passed: 0.0,
            before: None,
        })
    }

    /// One step of the driver; gives how much time went by since the last.
    fn step(&mut self, now: Time, torque: Joints<f64>, enabled: bool) -> (f64, Option<Reading>) {
        let elapsed = self.last.map(|last| now.seconds_since(last));
        let elapsed = elapsed.map(|own| own.clamp(0.0, LONGEST_STEP));
        self.last = Some(now);
        // A loop that was held up has not looked.
        let counts = elapsed.unwrap_or(0.0).min(2.5e-9 * STEP_NANOS as f64);
        self.passed += counts;
        if self.enabled != enabled {
            self.enabled = enabled;
            self.driver.enable(enabled);
        }
        let mut health = NodeHealth::default();
        self.driver
            .write(&DriverCommand { torque, elapsed }, &mut health);
        let reading = self.driver.read(&mut health);
        let reading = reading.filter(|_| self.driver.is_homed());
        let before = match (self.before, reading.is_some()) {
            (None, true) => {
                self.before = Some(self.passed);
                self.passed
            }
            (before, _) => before.unwrap_or(f64::INFINITY),
        };
        // Until the first reading a driver may say that it waits; what keeps it is told below.
        let homing = self.before.is_none() && self.passed < HOMING;
        if health.level >= Level::WARN && !homing {
            self.record.say(told(&health).as_str(), counts);
        }
        if let Some(reading) = reading {
            let stamp = self.driver.stamp();
            self.record.seen.push(Seen {
                at: self.passed - before,
                stamp: stamp.map(|own| own.nanos() as f64 * 1e-9),
                delay: stamp.map(|own| now.seconds_since(own)),
                reading,
            });
            self.last_reading = Some(reading);
        }
        (counts, reading)
    }

    /// How long it was looked since the first reading, or since the beginning.
    fn seconds(&self) -> f64 {
        self.passed - self.before.unwrap_or(0.0)
    }

    fn into_record(self) -> Record {
        let seconds = self.seconds();
        Record {
            seconds,
            ..self.record
        }
    }
}

/// What a driver says, in words.
fn told(health: &NodeHealth) -> Text<96> {
    match health.message.is_empty() {
        true => {
            let fault = health.faults.iter().next();
            Text::new(fault.map_or("", |own| own.name()))
        }
        false => health.message,
    }
}

/// Looks at the session's arm for `seconds` \[s\] from its first reading on, or until `stop`. It is
/// not moved: its drives stay off. A simulated arm, which has no brakes, is carried.
///
/// # Errors
///
/// What keeps its driver from being made.
pub fn look(
    session: &SessionContext,
    seconds: f64,
    stop: &AtomicBool,
) -> Result<Record, NodeError> {
    let mut bench = Bench::new(session)?;
    let model = &session.loaded.arm.model;
    let count = JointCount::new(model.joints().len())?;
    let (weight, rest) = (Weight::new(model, count), Joints::filled(count, 0.0));
    let simulated = Choice::of(session)?.is_stepped();
    let over = std::cell::Cell::new(false);
    let go_on = || !stop.load(Ordering::Relaxed) && !over.get();
    periodic::run_while(bench.clock, STEP_NANOS, go_on, |wake| {
        let torque = match bench.last_reading.filter(|_| simulated) {
            None => rest,
            Some(reading) => {
                let carried = weight.at(&reading.position);
                Joints::from_fn(count, |joint| {
                    carried[joint] - CARRY_DAMPING * reading.velocity[joint]
                })
            }
        };
        bench.step(wake.now, torque, simulated);
        let limit = match bench.before {
            Some(_) => seconds,
            None => seconds + HOMING,
        };
        over.set(bench.seconds() >= limit);
    });
    Ok(bench.into_record())
}

/// Moves the session's arm while `held` says that the key is held, until all joints were moved,
/// it is given up, or `stop`. `tell` hears what is happening as that changes.
///
/// # Errors
///
/// What keeps its driver from being made.
pub fn drive(
    session: &SessionContext,
    stop: &AtomicBool,
    mut held: impl FnMut(Time) -> bool,
    mut tell: impl FnMut(Progress),
) -> Result<(Record, Moved), NodeError> {
    let mut bench = Bench::new(session)?;
    let loaded = &session.loaded;
    let model = &loaded.arm.model;
    let mut mover = Mover::new(model, session.joints(), &loaded.scenario.servo)?;
    let count = JointCount::new(model.joints().len())?;
    let simulated = Choice::of(session)?.is_stepped();
    let weight = Weight::new(model, count);
    let mut torque = Joints::filled(count, 0.0);
    let (mut enabled, mut told) = (false, None);
    let over = std::cell::Cell::new(false);
    let go_on = || !stop.load(Ordering::Relaxed) && !over.get();
    periodic::run_while(bench.clock, STEP_NANOS, go_on, |wake| {
        let (elapsed, reading) = bench.step(wake.now, torque, enabled);
        let step = mover.step(wake.now, elapsed, reading.as_ref(), held(wake.now));
        (torque, enabled) = (step.torque, step.enabled);
        if let Some(last) = bench.last_reading.filter(|_| simulated && !enabled) {
            torque = weight.at(&last.position);
            enabled = true;
        }
        let progress = mover.progress();
        if told != Some(progress) {
            told = Some(progress);
            tell(progress);
        }
        let silent = bench.before.is_none() && bench.passed > HOMING;
        over.set(progress == Progress::Over || silent);
    });
    // The drives are left off.
    bench.step(bench.clock.now(), Joints::filled(count, 0.0), false);
    Ok((bench.into_record(), mover.into_moved()))
}
