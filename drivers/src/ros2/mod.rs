//! An arm that others drive, over ROS 2: `docs/ros2_driver.md` says how.
//!
//! `sensor_msgs/JointState` in, `std_msgs/Float64MultiArray` out, as ros2_control's forward command
//! controllers and the drivers of UR, Franka and OpenArm speak. What is told of the joints is
//! believed or not by [`states`], the servo's torque becomes a command in [`commands`], both pure;
//! ROS 2 itself is on a thread of its own ([`exchange`]).

mod commands;
mod exchange;
mod refusal;
mod settings;
mod states;

pub use settings::{Effort, Interface, Settings, SettingsError};

use ferntast_config::{ArmFile, ConfigError, serial::SerialFile};
use ferntast_control::estimator::Form;
use ferntast_model::{JointCount, Joints};
use ferntast_msgs::{
    Text, Time,
    sample::{Fault, JointNames, Level, RobotDescriptionSample},
};
use ferntast_nodes::{
    node::NodeHealth,
    process::{Clock, NodeError, SessionContext},
};
use serde_json::Value;

use crate::{
    driver::{Driver, DriverCommand, Measures, Reading},
    simulated::describe_serial,
    weight::Weight,
};
use commands::{Commands, Joint, Situation};
use exchange::{Exchange, Wiring};
use refusal::Refusal;
use states::{JointState, StateWatch};

/// Why a robot on ROS 2 is not driven.
#[derive(Debug, thiserror::Error)]
pub enum Ros2Error {
    /// Its settings.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// No thread for ROS 2.
    #[error("no thread for ROS 2: {0}")]
    Thread(std::io::Error),
}

/// The session's arm, driven over ROS 2; `text` is what stands behind `ros2:`.
pub(crate) fn driver(session: &SessionContext, text: &str) -> Result<Box<dyn Driver>, NodeError> {
    Ok(Box::new(Ros2::start(session, text)?))
}

/// An arm on ROS 2 behind the arm's node.
pub struct Ros2 {
    joints: JointNames,
    topic: String,
    effort: Effort,
    /// Beyond these the joints' torque sensors are saturated \[Nm\].
    sensor_ranges: Joints<f64>,
    clock: Clock,
    watch: StateWatch,
    commands: Commands,
    exchange: Exchange,
    gives_torque: bool,
    /// The servo's torques count.
    enabled: bool,
    /// They did once: before that nothing is commanded.
    commanded: bool,
    /// What went wrong on the ROS 2 side since joint states came last.
    problem: Option<Text<96>>,
    description: Option<RobotDescriptionSample>,
}

impl Ros2 {
    /// Joins ROS 2 as the driver of the session's arm. Nothing is commanded before the drives are
    /// enabled.
    ///
    /// # Errors
    ///
    /// [`Ros2Error`]; a parameter of the arm out of its bounds.
    pub fn start(session: &SessionContext, text: &str) -> Result<Ros2, NodeError> {
        let loaded = &session.loaded;
        let arm = &loaded.arm;
        let section = section(arm).map_err(NodeError::own)?;
        let refused = |error: SettingsError| NodeError::own(Ros2Error::from(error));
        let settings = Settings::read(section.as_ref(), text).map_err(refused)?;
        let (joints, believed) = (session.joints(), arm.model.joints());
        let count = JointCount::new(believed.len())?;
        let effort = settings.effort.unwrap_or(match arm.estimator.form {
            Form::MotorCurrent => Effort::MotorTorque,
            _ => Effort::JointTorque,
        });
        let tuning = loaded.scenario.servo.joints(count)?;
        let each = Joints::from_fn(count, |joint| Joint {
            range: [
                believed[joint].position_lower,
                believed[joint].position_upper,
            ],
            speed: believed[joint].velocity_limit,
            damping: tuning[joint].damping.max(1e-3),
            hold_damping: tuning[joint].hold_damping,
        });
        let wiring = Wiring {
            gateway: loaded.scenario.gateway.clone(),
            joint_states: settings.joint_states_topic().map_err(refused)?,
            command: settings.command_topic().map_err(refused)?,
            order: settings.order(&joints).map_err(refused)?,
            joints,
            count,
            clock: session.clock(),
        };
        Ok(Ros2 {
            joints,
            topic: settings.joint_states.clone(),
            effort,
            sensor_ranges: Joints::from_fn(count, |joint| believed[joint].torque_sensor_range),
            clock: wiring.clock,
            watch: StateWatch::new(count, believed, &settings, effort),
            commands: Commands::new(&settings, each, Weight::new(&arm.model, count)),
            exchange: Exchange::start(wiring)
                .map_err(|error| NodeError::own(Ros2Error::Thread(error)))?,
            gives_torque: settings.interface == Interface::Effort,
            enabled: false,
            commanded: false,
            problem: None,
            description: arm.model.serial().map(describe_serial),
        })
    }

    /// Sends the next command; none before the drives were enabled, or before the robot told
    /// where its joints are.
    fn command(&mut self, now: Time, torque: &Joints<f64>, elapsed: f64) {
        let Some(state) = self.watch.good().filter(|_| self.commanded) else {
            return;
        };
        let believed = self.watch.refusal(now).is_none();
        let sensed = self.effort == Effort::JointTorque;
        let command = self.commands.next(&Situation {
            torque: Some(torque).filter(|_| self.enabled),
            elapsed,
            position: &state.position,
            velocity: Some(&state.velocity).filter(|_| believed),
            joint_torque: Some(&state.effort).filter(|_| sensed),
        });
        self.exchange.send(now, &command);
    }

    fn reading(&self, state: &JointState, health: &mut NodeHealth) -> Reading {
        let own = |effort| (self.effort == effort).then_some(state.effort);
        let joint_torque = own(Effort::JointTorque);
        let mut torques = joint_torque.iter().flat_map(|own| own.iter());
        let mut ranges = self.sensor_ranges.iter();
        if torques.any(|own| ranges.next().is_some_and(|range| own.abs() > *range)) {
            health.raise(Fault::TorqueSaturated, Level::WARN);
        }
        Reading {
            position: state.position,
            velocity: state.velocity,
            joint_torque,
            motor_torque: own(Effort::MotorTorque),
            temperature: None,
        }
    }

    fn raise(&self, refusal: Refusal, health: &mut NodeHealth) {
        health.raise(refusal.fault(), Level::ERROR);
        health.message = match (refusal.fault(), self.problem) {
            // Why nothing comes is known.
            (Fault::MeasurementSilent, Some(problem)) => problem,
            _ => refusal.words(&self.joints, &self.topic),
        };
    }
}

/// The section `[driver.ros2]` of the arm's file, where that is one of a serial arm.
fn section(arm: &ArmFile) -> Result<Option<Value>, ConfigError> {
    if arm.model.serial().is_none() {
        return Ok(None);
    }
    let file: SerialFile = arm.whole()?;
    Ok(file.driver.and_then(|own| own.get("ros2").cloned()))
}

impl Driver for Ros2 {
    fn joints(&self) -> JointNames {
        self.joints
    }

    fn measures(&self) -> Measures {
        Measures {
            joint_torque: self.effort == Effort::JointTorque,
            motor_torque: self.effort == Effort::MotorTorque,
            temperature: false,
        }
    }

    fn gives_torque(&self) -> bool {
        self.gives_torque
    }

    /// Once the robot has told of all joints.
    fn is_homed(&self) -> bool {
        self.watch.good().is_some()
    }

    fn enable(&mut self, enabled: bool) {
        self.enabled = enabled;
        self.commanded |= enabled;
    }

    fn write(&mut self, command: &DriverCommand, health: &mut NodeHealth) {
        if command.torque.iter().any(|own| !own.is_finite()) {
            health.raise(Fault::CommandInvalid, Level::ERROR);
            return;
        }
        let now = self.clock.now();
        self.command(now, &command.torque, command.elapsed.unwrap_or(0.0));
    }

    fn read(&mut self, health: &mut NodeHealth) -> Option<Reading> {
        let mut fresh = false;
        while let Some(state) = self.exchange.state() {
            fresh = self.watch.take(state);
            self.problem = None;
        }
        self.problem = self.exchange.problem().or(self.problem);
        if let Some(refusal) = self.watch.refusal(self.clock.now()) {
            self.raise(refusal, health);
            return None;
        }
        let state = self.watch.good().filter(|_| fresh)?;
        Some(self.reading(state, health))
    }

    fn failure(&self) -> Option<String> {
        let why = self.problem.map(|own| own.to_string()).unwrap_or_default();
        let ended = self.exchange.has_ended();
        ended.then(|| format!("nothing goes to or comes from ROS 2 any more: {why}"))
    }

    fn stamp(&self) -> Option<Time> {
        self.watch.good().map(|state| state.stamp)
    }

    fn description(&mut self) -> Option<RobotDescriptionSample> {
        self.description.take()
    }
}

impl Drop for Ros2 {
    /// The controller would go on with its last command for ever: it is told to stay.
    fn drop(&mut self) {
        self.enabled = false;
        let rest = self.sensor_ranges.map(|_| 0.0);
        self.command(self.clock.now(), &rest, 0.0);
    }
}
