//! The follower's joint servo as a node.

mod friction;
mod summary;
#[cfg(test)]
mod tests;

pub use summary::{FrictionParameter, FrictionSummary};

use std::borrow::Cow;

use ferntast_config::Believed;
use ferntast_control::{
    operating,
    orientation::Orientation,
    planted::Planted,
    servo::{
        CLOCK_TOLERANCE, Command, CommandRefusal, Measurement, Servo, ServoConfig,
        ServoInput as LawInput, ServoOutput as LawOutput, Target,
    },
};
use ferntast_model::{JointCount, Joints, ParameterError};
use ferntast_msgs::{
    Text, Time,
    sample::{
        CommandStatusSample, Fault, FrictionCommandSample, FrictionStatusSample, JointFields,
        JointNames, JointSample, Level, OperatingStateSample, PoseSample, StateCommand,
        StateCommandSample, TemperatureSample, TwinParametersSample,
    },
};

use friction::FrictionCommands;

use crate::{
    graph::Build,
    node::{Newest, Node, PerJoint, StatePublisher, Ticking, ports, to_law},
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
        twin: Batch<TwinParametersSample> = TWIN_PARAMETERS,
        temperature: PerJoint<Newest<TemperatureSample>> = FOLLOWER_JOINT_TEMPERATURE,
    }
    /// What the servo gives.
    output ServoOutput {
        torque: JointSample = FOLLOWER_SERVO_JF,
        setpoint_js: JointSample = FOLLOWER_SETPOINT_JS,
        operating_state: OperatingStateSample = FOLLOWER_OPERATING_STATE,
        command_status: CommandStatusSample = FOLLOWER_COMMAND_STATUS,
        friction: PerJoint<FrictionStatusSample> = FOLLOWER_JOINT_FRICTION,
    }
}

/// A `resume` that was said so long before the arm stopped at most crossed the stop [s].
/// By its stamp, which may be of another clock: what is further apart is none.
const CROSSING: f64 = 0.020;

/// The node of the graph.
///
/// # Errors
///
/// A parameter out of its bounds, a topic that cannot be opened.
pub fn make(build: Build) -> Result<Box<dyn Ticking>, NodeError> {
    let loaded = &build.session.loaded;
    let node = ServoNode::new(&loaded.arm.model, &loaded.scenario.servo)?;
    let node = node.planted(build.session.planted);
    let ports = ServoPorts::connect(build.bus, &build.session.joints())?;
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
    /// When the arm last ceased to follow commands.
    left: Time,
}

impl ServoNode {
    /// A servo, disabled, for the arm as it is believed.
    ///
    /// # Errors
    ///
    /// A parameter out of its bounds.
    pub fn new(model: &Believed, config: &ServoConfig) -> Result<ServoNode, ParameterError> {
        let servo = match model {
            Believed::Planar(model) => Servo::planar(&model.joint, &model.arm, config)?,
            Believed::Serial(serial) => Servo::serial(&serial.arm, config)?,
        };
        Ok(ServoNode {
            joints: model.joint_names(),
            servo,
            states: StatePublisher::default(),
            friction: FrictionCommands::new(model.joint_names()),
            message: Text::EMPTY,
            commands_due: Time::INVALID,
            refusal: Text::EMPTY,
            left: Time::INVALID,
        })
    }

    /// The same with a planted bug.
    pub fn planted(self, planted: Planted) -> ServoNode {
        ServoNode {
            servo: self.servo.planted(planted),
            ..self
        }
    }
}

/// The newest command of either kind. One of a time to come is refused, and so stands in nobody's
/// way once that is told.
fn command(
    now: Time,
    input: &ServoInput,
    servo_jp: Option<&JointSample>,
    joints: JointCount,
) -> Option<Command> {
    let latest_ns = now.plus_seconds(CLOCK_TOLERANCE).nanos();
    let counts = |own: &Command, is_fresh: bool| is_fresh || own.stamp_ns <= latest_ns;
    let tip = input.servo_cp.message.map(|pose| Command {
        stamp_ns: pose.stamp.nanos(),
        target: match Orientation::given(pose.orientation) {
            Some(orientation) => Target::Pose(pose.position, orientation),
            None => Target::Tip(pose.position),
        },
    });
    let tip = tip.filter(|own| counts(own, input.servo_cp.fresh().is_some()));
    let position = servo_jp
        .filter(|sample| sample.fields.has(JointFields::POSITION))
        .map(|sample| Command {
            stamp_ns: sample.stamp.nanos(),
            target: Target::Joints(Joints::from_places(joints, sample.position)),
        });
    let position = position.filter(|own| counts(own, input.servo_jp.fresh().is_some()));
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
        let measured = measured.as_deref();
        let servo_jp = self.own(&input.servo_jp, Fault::CommandInvalid, output);
        let joints = self.servo.joints();
        let law_input = LawInput {
            measurement: measured.map(|sample| Measurement {
                stamp_ns: sample.stamp.nanos(),
                position: Joints::from_places(joints, sample.position),
                velocity: Joints::from_places(joints, sample.velocity),
                torque: Joints::from_places(joints, sample.effort),
            }),
            command: command(now, input, servo_jp.as_deref(), joints),
            state_command: self.state_command(input, output),
        };
        self.feed_forward(now, input, output);
        let was_enabled = self.servo.state() == operating::OperatingState::Enabled;
        let law = self.servo.step(now.nanos(), &law_input);
        if was_enabled && law.state != operating::OperatingState::Enabled {
            self.left = now;
        }
        self.report(&law, output);
        let empty = JointSample::empty(self.joints, now);
        let torque = output.torque.insert(empty);
        torque.set_effort(&law.torque);
        let setpoint = output.setpoint_js.insert(*torque);
        setpoint.set_position(&law.setpoint.map(|own| own.position));
        setpoint.set_velocity(&law.setpoint.map(|own| own.velocity));
        output.operating_state = self
            .states
            .publish(now, law.state, law.reason, law.approaching);
        output.command_status = self.command_status(now, &law);
    }
}

impl ServoNode {
    /// The one state command of a step. Of several in the same millisecond nobody knows
    /// which was said first: one that stops counts, or else the last. A `resume` that was
    /// said just before the arm stopped was not said of that stop, and is refused.
    fn state_command(
        &mut self,
        input: &ServoInput,
        output: &mut ServoOutput,
    ) -> Option<operating::StateCommand> {
        let outdated = |sample: &StateCommandSample| {
            let crossed = self.left.is_valid()
                && (0.0..=CROSSING).contains(&self.left.seconds_since(sample.stamp));
            sample.command == StateCommand::RESUME && crossed
        };
        if input.state_command.iter().any(outdated) {
            output.health.raise(Fault::StateCommandRefused, Level::WARN);
            self.message = Text::new("resume was said just before the arm stopped; say it again");
        }
        let all = || {
            let samples = input.state_command.iter().filter(|own| !outdated(own));
            samples.filter_map(|sample| to_law(sample.command))
        };
        let told = |own: operating::StateCommand| all().find(|command| *command == own);
        told(operating::StateCommand::Disable)
            .or_else(|| told(operating::StateCommand::Pause))
            .or_else(|| all().last())
    }

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
    fn own<'a>(
        &mut self,
        newest: &'a Newest<JointSample>,
        fault: Fault,
        output: &mut ServoOutput,
    ) -> Option<Cow<'a, JointSample>> {
        let sample = newest.message.as_ref()?;
        let own = sample.in_order_of(&self.joints);
        if own.is_none() && newest.fresh {
            output.health.raise(fault, Level::WARN);
            let (found, needed) = (&sample.joints, &self.joints);
            self.message = Text::display(format_args!("joints {found} where {needed} are needed"));
        }
        own
    }

    fn feed_forward(&mut self, now: Time, input: &ServoInput, output: &mut ServoOutput) {
        for (joint, newest) in input.temperature.iter().enumerate() {
            if let Some(sample) = newest.message {
                self.servo.set_temperature(joint, sample.temperature);
            }
        }
        for twin in input.twin.iter() {
            self.friction.hear(twin);
        }
        for command in input.friction_command.iter() {
            match self.friction.follow(now, command, &mut self.servo) {
                Ok(words) => self.message = words,
                Err(refusal) => {
                    output.health.raise(Fault::TakeOverRefused, Level::WARN);
                    self.message = Text::display(refusal);
                }
            }
        }
        if let Some(told) = self.friction.tell(now, &self.servo) {
            for (place, told) in output.friction.iter_mut().zip(told) {
                *place = Some(told);
            }
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
                operating::Event::MeasurementFrozen(_) | operating::Event::MeasurementJumped(_) => {
                    (Fault::MeasurementInvalid, Level::ERROR)
                }
                operating::Event::JointLimit(_) => (Fault::JointLimit, Level::ERROR),
                operating::Event::Overspeed(_) => (Fault::JointOverspeed, Level::ERROR),
            };
            health.raise(fault, level);
            self.message = Text::display(law.reason);
        }
        health.message = self.message;
    }
}
