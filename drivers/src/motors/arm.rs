//! Motors on a bus as the arm's driver.

use std::{
    sync::{Arc, atomic::Ordering},
    thread::JoinHandle,
};

use ferntast_model::{JointCount, Joints, MAX_JOINTS, ParameterError};
use ferntast_msgs::{
    Text,
    sample::{Fault, JointNames, Level, RobotDescriptionSample},
};
use ferntast_nodes::{
    node::NodeHealth,
    process::{NodeError, SessionContext},
};

use super::{
    error::MotorError,
    family::{Drive, Family},
    section::Section,
    shared::Shared,
    talk,
};
use crate::driver::{Driver, DriverCommand, Measures, Reading};

/// Steps of the node in which the rate of the bus is counted: a second.
const COUNTED: u32 = 1000;
/// Steps without anything new from which on that is told.
const QUIET: u32 = 25;
/// A bus that is slower \[Hz\] is told: a servo cannot work with it.
const SLOW: u32 = 100;

/// Motors on a bus. Dropped, their drives are switched off.
pub struct MotorArm {
    joints: JointNames,
    count: JointCount,
    section: Section,
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
    gives_torque: bool,
    /// Whether it has been commanded ever, and is now.
    was_enabled: bool,
    enabled: bool,
    /// Version of the newest reading, and how many steps ago it came.
    seen: u64,
    quiet: u32,
    /// Steps and readings since they are counted.
    steps: u32,
    readings: u32,
    /// What it says of itself, from second to second.
    told: Text<96>,
    slow: bool,
    description: Option<RobotDescriptionSample>,
}

impl MotorArm {
    /// The driver of the session's arm of `family`'s motors.
    ///
    /// # Errors
    ///
    /// As [`start`](Self::start).
    pub(crate) fn driver<F: Family>(
        session: &SessionContext,
        driver: &'static str,
        family: impl FnOnce(&Section) -> Result<F, MotorError>,
    ) -> Result<Box<dyn Driver>, NodeError> {
        let joints = session.joints();
        let arm = &session.loaded.arm;
        let section = Section::of(driver, arm, &joints).map_err(NodeError::own)?;
        let family = family(&section).map_err(NodeError::own)?;
        let description = arm.model.serial().map(crate::simulated::describe_serial);
        let motors = MotorArm::start(joints, section, family).map_err(NodeError::own)?;
        Ok(Box::new(motors.described(description)))
    }

    /// Looks for the motors and begins to talk to them; their drives are off.
    ///
    /// # Errors
    ///
    /// What is wrong with port or motors.
    pub fn start<F: Family>(
        joints: JointNames,
        section: Section,
        mut family: F,
    ) -> Result<MotorArm, MotorError> {
        let states = family.start()?;
        let shared = Arc::new(Shared::new());
        let bad = |error: ParameterError| MotorError::Section {
            driver: "motors",
            message: error.to_string(),
        };
        let count = JointCount::new(joints.len()).map_err(bad)?;
        let thread = talk::start(family, section.clone(), states, shared.clone())?;
        Ok(MotorArm {
            joints,
            count,
            section,
            shared,
            thread: Some(thread),
            gives_torque: F::GIVES_TORQUE,
            was_enabled: false,
            enabled: false,
            seen: 0,
            quiet: 0,
            steps: 0,
            readings: 0,
            told: Text::EMPTY,
            slow: false,
            description: None,
        })
    }

    /// The same with what it looks like.
    pub fn described(mut self, description: Option<RobotDescriptionSample>) -> MotorArm {
        self.description = description;
        self
    }

    /// Counts how fast the bus goes, and has something to tell every second.
    fn tally(&mut self, fresh: bool) {
        self.steps += 1;
        self.readings += u32::from(fresh);
        if self.steps < COUNTED {
            return;
        }
        let (port, rate) = (&self.section.port, self.readings);
        self.slow = rate < SLOW;
        self.told = match self.slow {
            false => Text::display(format_args!("{port}: {rate} readings a second")),
            true => Text::display(format_args!(
                "{port}: only {rate} readings a second; set the adapter's latency timer to 1 ms"
            )),
        };
        (self.steps, self.readings) = (0, 0);
    }
}

impl Driver for MotorArm {
    fn joints(&self) -> JointNames {
        self.joints
    }

    fn measures(&self) -> Measures {
        Measures {
            joint_torque: false,
            motor_torque: true,
            temperature: true,
        }
    }

    fn gives_torque(&self) -> bool {
        self.gives_torque
    }

    fn enable(&mut self, enabled: bool) {
        self.enabled = enabled;
        self.was_enabled |= enabled;
    }

    fn write(&mut self, command: &DriverCommand, health: &mut NodeHealth) {
        let mut currents = [0.0; MAX_JOINTS];
        let motors = self.section.motor.iter().zip(command.torque.iter());
        for (current, (motor, torque)) in currents.iter_mut().zip(motors) {
            let wanted = motor.current(*torque);
            if !wanted.is_finite() {
                health.raise(Fault::CommandInvalid, Level::ERROR);
                continue;
            }
            if wanted.abs() > motor.current_limit {
                health.raise(Fault::EffortLimited, Level::OK);
            }
            *current = wanted.clamp(-motor.current_limit, motor.current_limit);
        }
        // An arm that was carried is not dropped because nobody says anything for a moment.
        self.shared
            .put_drive(&match (self.enabled, self.was_enabled) {
                (true, _) => Drive::Currents(currents),
                (false, true) => Drive::Hold,
                (false, false) => Drive::Off,
            });
    }

    fn read(&mut self, health: &mut NodeHealth) -> Option<Reading> {
        if let Some(failure) = self.shared.failure.get() {
            health.raise(Fault::MeasurementSilent, Level::ERROR);
            health.message = Text::display(failure);
            return None;
        }
        let newest = self
            .shared
            .states()
            .filter(|(version, _)| *version != self.seen);
        self.tally(newest.is_some());
        health.lost = u64::from(self.shared.missed.load(Ordering::Relaxed));
        health.message = self.told;
        if self.slow {
            health.raise(Fault::MeasurementSilent, Level::WARN);
        }
        let Some((version, states)) = newest else {
            self.quiet += 1;
            if self.quiet > QUIET {
                health.raise(Fault::MeasurementSilent, Level::WARN);
            }
            return None;
        };
        (self.seen, self.quiet) = (version, 0);
        let motor = &self.section.motor;
        let each = |value: &dyn Fn(usize) -> f64| Joints::from_fn(self.count, value);
        Some(Reading {
            position: each(&|joint| motor[joint].position(states[joint].position)),
            velocity: each(&|joint| motor[joint].velocity(states[joint].velocity)),
            joint_torque: None,
            motor_torque: Some(each(&|joint| motor[joint].torque(states[joint].current))),
            temperature: Some(each(&|joint| states[joint].temperature)),
        })
    }

    fn failure(&self) -> Option<String> {
        self.shared.failure.get().map(ToString::to_string)
    }

    fn description(&mut self) -> Option<RobotDescriptionSample> {
        self.description.take()
    }
}

impl Drop for MotorArm {
    fn drop(&mut self) {
        self.shared.ends.store(true, Ordering::Release);
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has nothing to say any more.
            let _ = thread.join();
        }
    }
}
