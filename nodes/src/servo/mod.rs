//! The follower's joint servo as a node.

mod friction;
mod summary;
#[cfg(test)]
mod tests;

pub use summary::{FrictionParameter, FrictionSummary};

use ferntast_control::{
    operating,
    servo::{
        Command, CommandRefusal, Measurement, Servo, ServoConfig, ServoInput as LawInput,
        ServoOutput as LawOutput, Target,
    },
};
use ferntast_model::{ArmModel, JointCount, Joints, ParameterError};
use ferntast_msgs::{
    Text, Time,
    sample::{
        CommandStatusSample, Fault, FrictionCommandSample, FrictionStatusSample, JointFields,
        JointNames, JointSample, Level, OperatingStateSample, PoseSample, StateCommandSample,
        TemperatureSample, TwinParametersSample,
    },
};

use friction::FrictionCommands;

use crate::{
    config::joint_names,
    graph::Build,
    node::{Newest, Node, StatePublisher, Ticking, ports, to_law},
    process::NodeError,
};

/// How often the servo says what became of the commands \[ns\].
const COMMAND_STATUS_NANOS: i64 = 100_000_000;

ports! {
    /// The servo's topics.
    ServoPorts for ServoNode;
    /// What the servo takes.
    input ServoInput {
        measured_js: Newest<JointSample> = FOLLOWER_MEASURED_JS,
        servo_cp: Newest<PoseSample> = FOLLOWER_SERVO_CP,
        servo_jp: Newest<JointSample> = FOLLOWER_SERVO_JP,
        state_command: Batch<StateCommandSample> = FOLLOWER_STATE_COMMAND,
        friction_command: Batch<FrictionCommandSample> = FOLLOWER_FRICTION_COMMAND,
        twin: Newest<TwinParametersSample> = TWIN_PARAMETERS,
        temperature_1: Newest<TemperatureSample> = FOLLOWER_JOINT_1_TEMPERATURE,
        temperature_2: Newest<TemperatureSample> = FOLLOWER_JOINT_2_TEMPERATURE,
    }
    /// What the servo gives.
    output ServoOutput {
        torque: JointSample = FOLLOWER_SERVO_JF,
        setpoint_js: JointSample = FOLLOWER_SETPOINT_JS,
        operating_state: OperatingStateSample = FOLLOWER_OPERATING_STATE,
        command_status: CommandStatusSample = FOLLOWER_COMMAND_STATUS,
        friction_1: FrictionStatusSample = FOLLOWER_JOINT_1_FRICTION,
        friction_2: FrictionStatusSample = FOLLOWER_JOINT_2_FRICTION,
    }
}

/// The node of the graph.
///
/// # Errors
///
/// A parameter out of its bounds, a topic that cannot be opened.
pub fn make(build: Build) -> Result<Box<dyn Ticking>, NodeError> {
    let loaded = &build.session.loaded;
    let node = ServoNode::new(&loaded.arm.model, &loaded.scenario.servo)?;
    let ports = ServoPorts::connect(build.bus)?;
    build.join(node, ports)
}

/// The joint servo.
pub struct ServoNode {
    joints: JointNames,
    servo: Servo,
    states: StatePublisher,
    friction: FrictionCommands,
    message: Text<96>,
    commands_due: Time,
    refusal: Text<96>,
}

impl ServoNode {
    /// A servo, disabled, for the arm as it is believed.
    ///
    /// # Errors
    ///
    /// A parameter out of its bounds.
    pub fn new(model: &ArmModel, config: &ServoConfig) -> Result<ServoNode, ParameterError> {
        Ok(ServoNode {
            joints: joint_names(model),
            servo: Servo::new(&model.joint, Some(model.arm.kinematics()), config)?,
            states: StatePublisher::default(),
            friction: FrictionCommands::new(joint_names(model)),
            message: Text::EMPTY,
            commands_due: Time::INVALID,
            refusal: Text::EMPTY,
        })
    }
}

/// The newest command of either kind.
fn command(
    input: &ServoInput,
    servo_jp: Option<JointSample>,
    joints: JointCount,
) -> Option<Command> {
    let tip = input.servo_cp.message.map(|pose| Command {
        stamp_ns: pose.stamp.nanos(),
        target: Target::Tip(pose.position),
    });
    let position = servo_jp
        .filter(|sample| sample.fields.has(JointFields::POSITION))
        .map(|sample| Command {
            stamp_ns: sample.stamp.nanos(),
            target: Target::Joints(Joints::from_places(joints, sample.position)),
        });
    match (tip, position) {
        (Some(tip), Some(position)) if position.stamp_ns > tip.stamp_ns => Some(position),
        (Some(tip), _) => Some(tip),
        (None, position) => position,
    }
}

impl Node for ServoNode {
    type Input = ServoInput;
    type Output = ServoOutput;

    fn step(&mut self, now: Time, input: &ServoInput, output: &mut ServoOutput) {
        let measured = self.own(&input.measured_js, Fault::MeasurementInvalid, output);
        let servo_jp = self.own(&input.servo_jp, Fault::CommandInvalid, output);
        let joints = self.servo.joints();
        let law_input = LawInput {
            measurement: measured.map(|sample| Measurement {
                stamp_ns: sample.stamp.nanos(),
                position: Joints::from_places(joints, sample.position),
                velocity: Joints::from_places(joints, sample.velocity),
                torque: Joints::from_places(joints, sample.effort),
            }),
            command: command(input, servo_jp, joints),
            // One a step; a second in the same millisecond is the newer wish.
            state_command: input
                .state_command
                .iter()
                .last()
                .and_then(|sample| to_law(sample.command)),
        };
        self.feed_forward(now, input, output);
        let law = self.servo.step(now.nanos(), &law_input);
        self.report(&law, output);
        let torque = JointSample::empty(self.joints, now).with_effort(law.torque.into_places(0.0));
        output.torque = Some(torque);
        let position = law.setpoint.map(|setpoint| setpoint.position);
        let velocity = law.setpoint.map(|setpoint| setpoint.velocity);
        output.setpoint_js = Some(
            torque
                .with_position(position.into_places(0.0))
                .with_velocity(velocity.into_places(0.0)),
        );
        output.operating_state = self
            .states
            .publish(now, law.state, law.reason, law.approaching);
        output.command_status = self.command_status(now, &law);
    }
}

impl ServoNode {
    /// What became of the commands: ten times a second.
    fn command_status(&mut self, now: Time, law: &LawOutput) -> Option<CommandStatusSample> {
        if let Some(refusal) = &law.refused {
            self.refusal = Text::display(refusal);
        }
        if now < self.commands_due {
            return None;
        }
        self.commands_due = now.plus_nanos(COMMAND_STATUS_NANOS);
        let refused = &law.refusals;
        Some(CommandStatusSample {
            age: law.command_age,
            accepted: law.accepted,
            refused_stamp: refused.stamp,
            refused_time: refused.time,
            refused_value: refused.value,
            refused_range: refused.out_of_range,
            refused_jump: refused.jump,
            reason: self.refusal,
            ..CommandStatusSample::initial(now)
        })
    }

    /// The newest sample with its joints in the order of the arm's; one that is
    /// about others is refused.
    fn own(
        &mut self,
        newest: &Newest<JointSample>,
        fault: Fault,
        output: &mut ServoOutput,
    ) -> Option<JointSample> {
        let sample = newest.message?;
        let own = sample.in_order_of(&self.joints);
        if own.is_none() && newest.fresh {
            output.health.raise(fault, Level::WARN);
            let (found, needed) = (&sample.joints, &self.joints);
            self.message = Text::display(format_args!("joints {found} where {needed} are needed"));
        }
        own
    }

    fn feed_forward(&mut self, now: Time, input: &ServoInput, output: &mut ServoOutput) {
        let temperatures = [&input.temperature_1, &input.temperature_2];
        for (joint, newest) in temperatures.into_iter().enumerate() {
            if let Some(sample) = newest.message {
                self.servo.set_temperature(joint, sample.temperature);
            }
        }
        let twin = input.twin.message.as_ref();
        for command in input.friction_command.iter() {
            match self.friction.follow(now, command, twin, &mut self.servo) {
                Ok(words) => self.message = words,
                Err(refusal) => {
                    output.health.raise(Fault::TakeOverRefused, Level::WARN);
                    self.message = Text::display(refusal);
                }
            }
        }
        if let Some(mut told) = self.friction.tell(now, &self.servo) {
            output.friction_1 = told.next();
            output.friction_2 = told.next();
        }
    }

    fn report(&mut self, law: &LawOutput, output: &mut ServoOutput) {
        let health = &mut output.health;
        health.input_age = law.measurement_age;
        health.refused = law.refusals.total();
        if let Some(refusal) = &law.refused {
            let fault = match refusal {
                CommandRefusal::OutOfRange { .. } => Fault::CommandOutOfRange,
                CommandRefusal::Jump { .. } => Fault::CommandJumped,
                _ => Fault::CommandInvalid,
            };
            health.raise(fault, Level::WARN);
            self.message = Text::display(refusal);
        }
        if let Some(refusal) = &law.state_refused {
            health.raise(Fault::StateCommandRefused, Level::WARN);
            self.message = Text::display(refusal);
        }
        if law.effort_limited {
            health.raise(Fault::EffortLimited, Level::OK);
        }
        if law.velocity_limited {
            health.raise(Fault::VelocityLimited, Level::OK);
        }
        if let operating::Reason::Event(event) = law.reason {
            let (fault, level) = match event {
                operating::Event::CommandSilent => (Fault::CommandSilent, Level::WARN),
                operating::Event::MeasurementSilent => (Fault::MeasurementSilent, Level::ERROR),
                operating::Event::MeasurementInvalid => (Fault::MeasurementInvalid, Level::ERROR),
                operating::Event::JointLimit(_) => (Fault::JointLimit, Level::ERROR),
                operating::Event::Overspeed(_) => (Fault::JointOverspeed, Level::ERROR),
            };
            health.raise(fault, level);
            self.message = Text::display(law.reason);
        }
        health.message = self.message;
    }
}
