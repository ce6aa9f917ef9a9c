//! The simulated arm as a node; hardware takes its place by speaking the same
//! topics.

mod config;
mod description;

pub use config::{arm_file, load_arm, load_config};

use ferntast_msgs::{
    Time,
    sample::{Fault, JointSample, Level, RobotDescriptionSample, TemperatureSample},
};
use ferntast_nodes::{
    graph::{Build, NodeRow},
    node::{Node, Ticking, ports},
    process::NodeError,
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
        temperature_1: TemperatureSample = FOLLOWER_JOINT_1_TEMPERATURE,
        temperature_2: TemperatureSample = FOLLOWER_JOINT_2_TEMPERATURE,
        description: RobotDescriptionSample = ROBOT_DESCRIPTION,
    }
}

/// Its row in the graph.
pub const fn row() -> NodeRow {
    NodeRow::step::<ArmPorts>(
        "arm",
        "The simulated arm; hardware takes its place by speaking the same topics",
        make,
    )
}

fn make(build: Build) -> Result<Box<dyn Ticking>, NodeError> {
    let loaded = &build.session.loaded;
    let node = ArmNode::new(&loaded.arm.whole()?, loaded.scenario.seed).map_err(NodeError::own)?;
    let ports = ArmPorts::connect(build.bus)?;
    build.join(node, ports)
}

/// The simulated arm.
pub struct ArmNode {
    arm: SimulatedArm,
    last: Option<Time>,
    temperature_due: Time,
    /// What it looks like, until that is published.
    description: Option<RobotDescriptionSample>,
}

impl ArmNode {
    /// An arm at rest in the configured posture.
    ///
    /// # Errors
    ///
    /// A parameter out of its bounds, a posture that touches the contour.
    pub fn new(config: &ArmConfig, seed: u64) -> Result<ArmNode, SimulatedArmError> {
        Ok(ArmNode {
            arm: SimulatedArm::new(config, seed)?,
            last: None,
            temperature_due: Time::INVALID,
            description: Some(description::describe(&config.model())),
        })
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
        let torque = match &input.torque.message {
            Some(command) if silence <= COMMAND_LIFE => command.effort,
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
        output.description = self.description.take();
    }
}

impl ArmNode {
    fn publish(&mut self, now: Time, middle: Time, measured: &Measurement, output: &mut ArmOutput) {
        let sample = JointSample {
            position: measured.motor_position,
            velocity: measured.motor_velocity,
            effort: measured.joint_torque,
            ..JointSample::zero(now)
        };
        output.measured_js = Some(sample);
        output.motor_js = Some(JointSample {
            stamp: middle,
            effort: measured.motor_torque_from_current,
            ..sample
        });
        if now >= self.temperature_due {
            self.temperature_due = now.plus_nanos(TEMPERATURE_PERIOD_NANOS);
            let [first, second] = measured.temperature;
            output.temperature_1 = Some(TemperatureSample::new(now, first));
            output.temperature_2 = Some(TemperatureSample::new(now, second));
        }
    }
}
