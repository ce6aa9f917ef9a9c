//! The simulated serial arm as a node.

use ferntast_model::{JointCount, Joints};
use ferntast_msgs::{
    Time,
    sample::{Fault, JointNames, JointSample, Level, RobotDescriptionSample, TemperatureSample},
};
use ferntast_nodes::{
    config::serial::Serial,
    graph::Build,
    node::{Node, PerJoint, Ticking, ports},
    process::NodeError,
};
use ferntast_sim::serial_arm::SerialArm;

use super::{serial::truth, serial_description::describe_serial};

const COMMAND_LIFE: f64 = 0.010;
const LONGEST_STEP: f64 = 0.020;
const TEMPERATURE_PERIOD_NANOS: i64 = 100_000_000;

ports! {
    /// The arm's topics.
    SerialPorts for SerialNode;
    /// What the arm takes.
    input SerialInput { torque: Newest<JointSample> = FOLLOWER_SERVO_JF, }
    /// What the arm gives.
    output SerialOutput {
        measured_js: JointSample = FOLLOWER_MEASURED_JS,
        motor_js: JointSample = FOLLOWER_MOTOR_JS,
        temperature: PerJoint<TemperatureSample> = FOLLOWER_JOINT_TEMPERATURE,
        description: RobotDescriptionSample = ROBOT_DESCRIPTION,
    }
}

pub(super) fn make(build: Build, serial: &Serial) -> Result<Box<dyn Ticking>, NodeError> {
    let loaded = &build.session.loaded;
    let truth = truth(&loaded.arm)?;
    let limit = |joint: usize| serial.arm.joints()[joint].motor_torque_limit;
    let limits = Joints::from_fn(serial.arm.count(), limit);
    let arm = SerialArm::new(serial.arm.chain(), &limits, &truth, loaded.scenario.seed);
    let node = SerialNode {
        joints: serial.joints,
        count: serial.arm.count(),
        arm: arm.map_err(NodeError::own)?,
        last: None,
        temperature_due: Time::INVALID,
        description: Some(describe_serial(serial)),
    };
    let ports = SerialPorts::connect(build.bus, &build.session.joints())?;
    build.join(node, ports)
}

struct SerialNode {
    joints: JointNames,
    count: JointCount,
    arm: SerialArm,
    last: Option<Time>,
    temperature_due: Time,
    description: Option<RobotDescriptionSample>,
}

impl Node for SerialNode {
    type Input = SerialInput;
    type Output = SerialOutput;

    fn step(&mut self, now: Time, input: &SerialInput, output: &mut SerialOutput) {
        let silence = input.torque.silence(now);
        let command = input
            .torque
            .message
            .and_then(|own| own.in_order_of(&self.joints));
        let torque = match command {
            Some(command) if silence <= COMMAND_LIFE => {
                Joints::from_places(self.count, command.effort)
            }
            _ => Joints::filled(self.count, 0.0),
        };
        let mut middle = now;
        if let Some(last) = self.last {
            let elapsed = now.seconds_since(last).clamp(0.0, LONGEST_STEP);
            middle = now.plus_seconds(-0.5 * elapsed);
            if self.arm.advance(&torque, elapsed).limited.contains(&true) {
                output.health.raise(Fault::EffortLimited, Level::OK);
            }
        }
        self.last = Some(now);
        let measured = self.arm.measure();
        let places = |own: Joints<f64>| own.into_places(0.0);
        let sample = JointSample::empty(self.joints, now)
            .with_position(places(measured.motor_position))
            .with_velocity(places(measured.motor_velocity))
            .with_effort(places(measured.joint_torque));
        output.measured_js = Some(sample);
        output.motor_js = Some(JointSample {
            stamp: middle,
            ..sample.with_effort(places(measured.motor_torque_from_current))
        });
        if now >= self.temperature_due {
            self.temperature_due = now.plus_nanos(TEMPERATURE_PERIOD_NANOS);
            let temperatures = measured.temperature.into_iter();
            for (place, temperature) in output.temperature.iter_mut().zip(temperatures) {
                *place = Some(TemperatureSample::new(now, temperature));
            }
        }
        if self.description.is_some() {
            output.description = self.description.take();
        }
    }
}
