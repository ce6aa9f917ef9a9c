//! The simulated arm as a node; hardware takes its place by speaking the same
//! topics.

mod config;
mod description;
pub mod serial;
mod serial_description;
mod serial_node;

pub use config::{arm_file, load_arm, load_config};

use ferntast_control::planted::{Planted, Rule};
use ferntast_model::ArmModel;
use ferntast_msgs::{
    Time,
    sample::{Fault, JointNames, JointSample, Level, RobotDescriptionSample, TemperatureSample},
};
use ferntast_nodes::{
    config::joint_names,
    graph::{Build, NodeRow},
    node::{Node, PerJoint, Ticking, ports},
    process::{NodeError, Priority},
};
use ferntast_sim::arm::{ArmConfig, Measurement, SimulatedArm, SimulatedArmError};

/// A torque command older than this \[s\] no longer counts: the drives are off.
const COMMAND_LIFE: f64 = 0.010;
/// Longest time that is simulated in one step \[s\]; a loop that slept longer
/// lets the arm lose time rather than computing on.
const LONGEST_STEP: f64 = 0.020;
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

/// Its row in the graph.
pub const fn row() -> NodeRow {
    NodeRow::step::<ArmPorts>(
        "arm",
        "The simulated arm; hardware takes its place by speaking the same topics",
        Priority::Arm,
        make,
    )
}

fn make(build: Build) -> Result<Box<dyn Ticking>, NodeError> {
    let loaded = &build.session.loaded;
    if let Some(serial) = loaded.arm.model.serial() {
        return serial_node::make(build, serial);
    }
    let node = ArmNode::new(&loaded.arm.whole()?, loaded.scenario.seed).map_err(NodeError::own)?;
    let ports = ArmPorts::connect(build.bus, &build.session.joints())?;
    build.join(node, ports)
}

/// The simulated arm.
pub struct ArmNode {
    joints: JointNames,
    arm: SimulatedArm,
    last: Option<Time>,
    temperature_due: Time,
    /// What it looks like, until that is published.
    description: Option<RobotDescriptionSample>,
    planted: Planted,
}

impl ArmNode {
    /// An arm at rest in the configured posture.
    ///
    /// # Errors
    ///
    /// A parameter out of its bounds, a posture that touches the contour.
    pub fn new(config: &ArmConfig, seed: u64) -> Result<ArmNode, SimulatedArmError> {
        let arm = SimulatedArm::new(config, seed)?;
        Ok(ArmNode::of(arm, &config.model()))
    }

    /// The node of `arm` as it is now; `model` is what is believed of it.
    pub fn of(arm: SimulatedArm, model: &ArmModel) -> ArmNode {
        ArmNode {
            joints: joint_names(model),
            arm,
            last: None,
            temperature_due: Time::INVALID,
            description: Some(description::describe(model)),
            planted: Planted::NONE,
        }
    }

    /// The same with a planted bug.
    pub fn planted(self, planted: Planted) -> ArmNode {
        ArmNode { planted, ..self }
    }

    /// The arm itself, for those who look at what is true.
    pub fn arm(&self) -> &SimulatedArm {
        &self.arm
    }
}

impl Node for ArmNode {
    type Input = ArmInput;
    type Output = ArmOutput;

    fn step(&mut self, now: Time, input: &ArmInput, output: &mut ArmOutput) {
        let silence = input.torque.silence(now);
        output.health.input_age = if silence.is_finite() {
            silence
        } else {
            f64::NAN
        };
        let command = input
            .torque
            .message
            .map(|own| own.in_order_of(&self.joints));
        let torque = match command {
            Some(None) => {
                output.health.raise(Fault::CommandInvalid, Level::ERROR);
                [0.0; 2]
            }
            Some(Some(command))
                if silence <= COMMAND_LIFE || self.planted.lacks(Rule::DrivesOff) =>
            {
                command.effort()
            }
            Some(_) => {
                output.health.raise(Fault::CommandSilent, Level::WARN);
                [0.0; 2]
            }
            None => [0.0; 2],
        };
        // The current is held from one step to the next: what is measured of it belongs to the middle.
        let mut middle = now;
        if let Some(last) = self.last {
            let elapsed = now.seconds_since(last).clamp(0.0, LONGEST_STEP);
            middle = now.plus_seconds(-0.5 * elapsed);
            let flags = self.arm.advance(torque, elapsed);
            if flags.limited.contains(&true) {
                output.health.raise(Fault::EffortLimited, Level::OK);
            }
            if flags.not_finite.contains(&true) {
                output.health.raise(Fault::CommandInvalid, Level::ERROR);
            }
        }
        self.last = Some(now);
        let measured = self.arm.measure();
        if measured.torque_saturated.contains(&true) {
            output.health.raise(Fault::TorqueSaturated, Level::WARN);
        }
        self.publish(now, middle, &measured, output);
        // A long text: not moved about in every step.
        if self.description.is_some() {
            output.description = self.description.take();
        }
    }
}

impl ArmNode {
    fn publish(&mut self, now: Time, middle: Time, measured: &Measurement, output: &mut ArmOutput) {
        let sample = JointSample::empty(self.joints, now)
            .with_position(measured.motor_position)
            .with_velocity(measured.motor_velocity)
            .with_effort(measured.joint_torque);
        output.measured_js = Some(sample);
        output.motor_js = Some(JointSample {
            stamp: middle,
            ..sample.with_effort(measured.motor_torque_from_current)
        });
        if now >= self.temperature_due {
            self.temperature_due = now.plus_nanos(TEMPERATURE_PERIOD_NANOS);
            for (place, temperature) in output.temperature.iter_mut().zip(measured.temperature) {
                *place = Some(TemperatureSample::new(now, temperature));
            }
        }
    }
}
