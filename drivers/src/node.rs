//! The arm's node: topics on one side, a driver on the other.

use std::any::Any;

use ferntast_control::{
    LONGEST_STEP,
    planted::{Planted, Rule},
    servo::TORQUE_LIFE,
};
use ferntast_model::{JointCount, Joints, ParameterError};
use ferntast_msgs::{
    Time,
    sample::{Fault, JointNames, JointSample, Level, RobotDescriptionSample, TemperatureSample},
};
use ferntast_nodes::{
    graph::Build,
    node::{Node, PerJoint, Ticking, ports},
    process::NodeError,
};

use crate::driver::{Driver, DriverCommand, Reading};

/// Steps between two temperatures \[ns\].
const TEMPERATURE_PERIOD_NANOS: i64 = 100_000_000;

ports! {
    /// The arm's topics.
    ArmPorts for ArmNode;
    /// What the arm takes.
    input ArmInput { torque: Newest<JointSample> = FOLLOWER_SERVO_JF, }
    /// What the arm gives.
    output ArmOutput {
        measured_js: JointSample = FOLLOWER_MEASURED_JS,
        motor_js: JointSample = FOLLOWER_MOTOR_JS,
        temperature: PerJoint<TemperatureSample> = FOLLOWER_JOINT_TEMPERATURE,
        description: RobotDescriptionSample = ROBOT_DESCRIPTION,
    }
}

/// The arm's node.
pub struct ArmNode {
    joints: JointNames,
    count: JointCount,
    driver: Box<dyn Driver>,
    enabled: bool,
    last: Option<Time>,
    temperature_due: Time,
    /// What it looks like, until that is published.
    description: Option<RobotDescriptionSample>,
    planted: Planted,
}

impl ArmNode {
    /// The node of the arm behind `driver`.
    ///
    /// # Errors
    ///
    /// A driver without joints.
    pub fn new(mut driver: Box<dyn Driver>) -> Result<ArmNode, ParameterError> {
        let joints = driver.joints();
        Ok(ArmNode {
            joints,
            count: JointCount::new(joints.len())?,
            enabled: false,
            last: None,
            temperature_due: Time::INVALID,
            description: driver.description(),
            planted: Planted::NONE,
            driver,
        })
    }

    /// The same with a planted bug.
    pub fn planted(self, planted: Planted) -> ArmNode {
        ArmNode { planted, ..self }
    }

    /// Its driver, for those who look at what is true; `None` where it is of another kind.
    pub fn driver<D: Driver>(&self) -> Option<&D> {
        let driver: &dyn Any = &*self.driver;
        driver.downcast_ref()
    }

    /// Joins it to its topics.
    ///
    /// # Errors
    ///
    /// A topic that cannot be opened.
    pub fn join(self, build: Build) -> Result<Box<dyn Ticking>, NodeError> {
        let ports = ArmPorts::connect(build.bus, &self.joints)?;
        build.join(self, ports)
    }

    /// The torques that count now, and whether the drives are to follow them.
    fn command(&self, now: Time, input: &ArmInput, output: &mut ArmOutput) -> Option<Joints<f64>> {
        let silence = input.torque.silence(now);
        output.health.input_age = if silence.is_finite() {
            silence
        } else {
            f64::NAN
        };
        let own = input.torque.message.as_ref()?.in_order_of(&self.joints);
        let Some(command) = own else {
            output.health.raise(Fault::CommandInvalid, Level::ERROR);
            return None;
        };
        if silence > TORQUE_LIFE && !self.planted.lacks(Rule::DrivesOff) {
            output.health.raise(Fault::CommandSilent, Level::WARN);
            return None;
        }
        Some(Joints::from_places(self.count, command.effort))
    }

    fn publish(&mut self, now: Time, middle: Time, reading: &Reading, output: &mut ArmOutput) {
        let empty = JointSample::empty(self.joints, now);
        let measured = output.measured_js.insert(empty);
        measured.set_position(&reading.position);
        measured.set_velocity(&reading.velocity);
        let motor = output.motor_js.insert(*measured);
        motor.stamp = middle;
        if let Some(torque) = &reading.joint_torque {
            measured.set_effort(torque);
        }
        if let Some(torque) = &reading.motor_torque {
            motor.set_effort(torque);
        }
        let Some(temperature) = reading.temperature else {
            return;
        };
        if now >= self.temperature_due {
            self.temperature_due = now.plus_nanos(TEMPERATURE_PERIOD_NANOS);
            for (place, temperature) in output.temperature.iter_mut().zip(temperature) {
                *place = Some(TemperatureSample::new(now, temperature));
            }
        }
    }
}

impl Node for ArmNode {
    type Input = ArmInput;
    type Output = ArmOutput;

    fn failure(&self) -> Option<String> {
        self.driver.failure()
    }

    fn step(&mut self, now: Time, input: &ArmInput, output: &mut ArmOutput) {
        let torque = self.command(now, input, output);
        if self.enabled != torque.is_some() {
            self.enabled = torque.is_some();
            self.driver.enable(self.enabled);
        }
        let since = |last| now.seconds_since(last).clamp(0.0, LONGEST_STEP);
        let command = DriverCommand {
            torque: torque.unwrap_or_else(|| Joints::filled(self.count, 0.0)),
            elapsed: self.last.map(since),
        };
        // The current is held from one step to the next: what is measured of it belongs to the middle.
        let middle = now.plus_seconds(-0.5 * command.elapsed.unwrap_or(0.0));
        self.last = Some(now);
        self.driver.write(&command, &mut output.health);
        let reading = self.driver.read(&mut output.health);
        if let Some(reading) = reading.filter(|_| self.driver.is_homed()) {
            self.publish(now, middle, &reading, output);
        }
        // A long text: not moved about in every step.
        if self.description.is_some() {
            output.description = self.description.take();
        }
    }
}
