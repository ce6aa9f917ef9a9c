//! The follower's 1 kHz joint servo with CRTK operating states.
//!
//! One call of [`Servo::step`] a period: measurement, newest command and state
//! command in; motor torques, setpoint, state and everything refused or
//! limited out.
//!
//! **When commands count.** After `enable` or `resume` the arm holds where it
//! is, with full gains, and waits: no command yet is not a silent command. The
//! first valid command starts the watchdog; from then on a silence longer than
//! [`ServoConfig::command_watchdog`] pauses the arm, latched until `resume`.
//! Refused commands do not feed the watchdog. The first command may be anywhere
//! in the workspace; the setpoint goes there from where the arm is, at the
//! approach speed, and never jumps. Commands that arrive while the arm is not
//! enabled are neither acted on nor remembered. Time in which the servo itself
//! was held up does not count as silence of others, if they are heard again
//! within 5 ms.

mod command;
mod compliance;
mod config;
mod feed_forward;
mod law;
mod setpoint;
mod stall;
mod take_over;
#[cfg(test)]
mod tests;

pub use command::{Command, CommandCheck, CommandRefusal, Range, RefusalCounts, Target};
pub use compliance::{stiffest, tip_compliance};
pub use config::ServoConfig;
pub use feed_forward::{FedForward, FedTorque, FeedForward, MAX_TERMS};
pub use law::{LimitedTorque, PositionLaw};
pub use setpoint::{Setpoint, SetpointGenerator, SetpointLimits};
pub use take_over::{FoundParameter, LeftOut, TakeOverConfig, TakeOverRefusal, TakenOver};

use self::stall::Stall;
use crate::operating::{Event, OperatingState, Reason, StateCommand, StateMachine, StateRefusal};
use crate::{nanoseconds, seconds};
use ferntast_model::arm::ArmParameters;
use ferntast_model::joint::JointParameters;
use ferntast_model::kinematics::Elbow;
use ferntast_model::{JOINTS, ParameterError, Vector2, check};

/// What the arm measures, on the joint side of the gear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// When it was measured \[ns since the UNIX epoch\].
    pub stamp_ns: i64,
    /// Motor positions \[rad\].
    pub position: [f64; JOINTS],
    /// Motor velocities \[rad/s\].
    pub velocity: [f64; JOINTS],
    /// Joint torques \[Nm\]; zeros when there is no sensor.
    pub torque: [f64; JOINTS],
}

impl Measurement {
    fn is_finite(&self) -> bool {
        [self.position, self.velocity, self.torque]
            .iter()
            .flatten()
            .all(|value| value.is_finite())
    }
}

/// What a step of the servo takes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ServoInput {
    /// The newest measurement.
    pub measurement: Option<Measurement>,
    /// The newest command; the same one may be given many times.
    pub command: Option<Command>,
    /// A state command that came since the last step.
    pub state_command: Option<StateCommand>,
}

/// What a step of the servo gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoOutput {
    /// Motor torques τ_m, joint side \[Nm\].
    pub torque: [f64; JOINTS],
    /// Where the joints should be.
    pub setpoint: [Setpoint; JOINTS],
    /// The operating state.
    pub state: OperatingState,
    /// Why it is in this state.
    pub reason: Reason,
    /// The command refused in this step.
    pub refused: Option<CommandRefusal>,
    /// The state command refused in this step.
    pub state_refused: Option<StateRefusal>,
    /// Commands refused since the start.
    pub refusals: RefusalCounts,
    /// Commands acted on since the start.
    pub accepted: u64,
    /// A motor torque is at its limit.
    pub effort_limited: bool,
    /// The setpoint is at its limit of velocity or acceleration.
    pub velocity_limited: bool,
    /// The setpoint is on its way to the first command.
    pub approaching: bool,
    /// Time since the last valid command \[s\]; NaN before the first after
    /// enable or resume.
    pub command_age: f64,
    /// Age of the measurement \[s\]; NaN without one.
    pub measurement_age: f64,
}

/// The joint servo.
#[derive(Clone, Debug)]
pub struct Servo {
    period: f64,
    command_watchdog_ns: i64,
    measurement_watchdog_ns: i64,
    machine: StateMachine,
    commands: CommandCheck,
    laws: [PositionLaw; JOINTS],
    generators: [SetpointGenerator; JOINTS],
    /// Where it was paused [rad].
    hold: [f64; JOINTS],
    /// Measured positions outside this are a fault [rad].
    fault_range: [[f64; 2]; JOINTS],
    limits: [[f64; 2]; JOINTS],
    limit_margin: f64,
    overspeed: [f64; JOINTS],
    last_command_ns: Option<i64>,
    stall: Stall,
    refusals: RefusalCounts,
    accepted: u64,
}

impl Servo {
    /// A servo for the arm as it is believed to be.
    ///
    /// # Errors
    ///
    /// The first value of `config` or of the joints that is out of bounds.
    pub fn new(
        arm: &ArmParameters,
        joints: &[JointParameters; JOINTS],
        config: &ServoConfig,
    ) -> Result<Servo, ParameterError> {
        config.validate()?;
        let key = |index: usize| format!("joint[{index}]");
        for (index, joint) in joints.iter().enumerate() {
            joint
                .validate()
                .map_err(|error| error.within(&key(index)))?;
            let share = config.approach_speed / joint.velocity_limit;
            check("approach_speed / velocity_limit", share, 0.0, 1.0, "-")
                .map_err(|error| error.within(&key(index)))?;
        }
        let lower = [0, 1].map(|index: usize| joints[index].position_lower);
        let upper = [0, 1].map(|index: usize| joints[index].position_upper);
        let limits = [0, 1].map(|index: usize| [lower[index], upper[index]]);
        let law = |index: usize| {
            PositionLaw::new(&joints[index], index, config)
                .map_err(|error| error.within(&key(index)))
        };
        let generator = |index: usize| {
            SetpointGenerator::new(
                config.tracker_frequency,
                SetpointLimits {
                    velocity: config.velocity_share * joints[index].velocity_limit,
                    acceleration: config.acceleration_limit[index],
                    approach: config.approach_speed,
                    lower: lower[index],
                    upper: upper[index],
                },
            )
        };
        Ok(Servo {
            period: config.period,
            command_watchdog_ns: nanoseconds(config.command_watchdog),
            measurement_watchdog_ns: nanoseconds(config.measurement_watchdog),
            machine: StateMachine::default(),
            commands: CommandCheck::new(arm.kinematics(), lower, upper, config),
            laws: [law(0)?, law(1)?],
            generators: [generator(0), generator(1)],
            hold: [0.0; JOINTS],
            fault_range: limits,
            limits,
            limit_margin: config.limit_margin,
            overspeed: [0, 1]
                .map(|index: usize| config.overspeed_share * joints[index].velocity_limit),
            last_command_ns: None,
            stall: Stall::default(),
            refusals: RefusalCounts::default(),
            accepted: 0,
        })
    }

    /// The operating state.
    pub fn state(&self) -> OperatingState {
        self.machine.state()
    }

    /// The friction that is fed forward at each joint.
    pub fn feed_forward(&self) -> [&FeedForward; JOINTS] {
        self.laws.each_ref().map(PositionLaw::feed_forward)
    }

    /// The same at joint number `joint` (from 0), to be told other friction.
    pub fn feed_forward_mut(&mut self, joint: usize) -> Option<&mut FeedForward> {
        self.laws.get_mut(joint).map(PositionLaw::feed_forward_mut)
    }

    /// What the temperature of joint number `joint` (from 0) is now \[degC\].
    pub fn set_temperature(&mut self, joint: usize, temperature: f64) {
        if let Some(own) = self.feed_forward_mut(joint) {
            own.set_temperature(temperature);
        }
    }

    /// One period at `now_ns` \[ns since the UNIX epoch\].
    pub fn step(&mut self, now_ns: i64, input: &ServoInput) -> ServoOutput {
        let stalled_ns = self.stall.step(now_ns);
        for law in &mut self.laws {
            law.feed_forward_mut().step(self.period);
        }
        let measurement = self.usable(now_ns - stalled_ns, input.measurement.as_ref());
        let was = self.machine.state();
        let state_refused = input
            .state_command
            .and_then(|command| self.machine.command(command, measurement.is_ok()).err());
        match &measurement {
            Err(event) => {
                self.machine.event(*event);
            }
            Ok(measured) => {
                if was != OperatingState::Enabled && self.state() == OperatingState::Enabled {
                    self.arm(measured);
                }
                self.supervise(measured);
            }
        }
        let refused = input
            .command
            .and_then(|command| self.take(&command, now_ns).err());
        self.watch(now_ns - stalled_ns);
        if was == OperatingState::Enabled
            && self.state() == OperatingState::Paused
            && let Ok(measured) = &measurement
        {
            self.hold = measured.position;
        }

        let mut output = ServoOutput {
            torque: [0.0; JOINTS],
            setpoint: [Setpoint::default(); JOINTS],
            state: self.machine.state(),
            reason: self.machine.reason(),
            refused,
            state_refused,
            refusals: self.refusals,
            accepted: self.accepted,
            effort_limited: false,
            velocity_limited: false,
            approaching: false,
            command_age: self
                .last_command_ns
                .map_or(f64::NAN, |last| seconds(now_ns - last)),
            measurement_age: input
                .measurement
                .map_or(f64::NAN, |own| seconds(now_ns.saturating_sub(own.stamp_ns))),
        };
        match measurement {
            Ok(measured) => self.drive(&measured, &mut output),
            Err(_) => output.setpoint = self.generators.map(|own| own.setpoint()),
        }
        output
    }

    /// The measurement, when it can be used.
    fn usable(&self, now_ns: i64, newest: Option<&Measurement>) -> Result<Measurement, Event> {
        let Some(measured) = newest else {
            return Err(Event::MeasurementSilent);
        };
        let silent = now_ns.saturating_sub(measured.stamp_ns) > self.measurement_watchdog_ns;
        if measured.stamp_ns <= 0 || silent {
            return Err(Event::MeasurementSilent);
        }
        if !measured.is_finite() {
            return Err(Event::MeasurementInvalid);
        }
        Ok(*measured)
    }

    /// Starts from where the arm is. An arm that stands outside its limits
    /// may be enabled to be brought back: only further out is a fault then.
    fn arm(&mut self, measured: &Measurement) {
        self.last_command_ns = None;
        self.commands.rearm();
        let margin = self.limit_margin;
        for joint in 0..JOINTS {
            let position = measured.position[joint];
            self.generators[joint].start(position);
            let [lower, upper] = self.limits[joint];
            self.fault_range[joint] = [position.min(lower) - margin, position.max(upper) + margin];
        }
    }

    fn supervise(&mut self, measured: &Measurement) {
        for joint in 0..JOINTS {
            let number = joint as u8 + 1;
            let [lower, upper] = self.fault_range[joint];
            if !(lower..=upper).contains(&measured.position[joint]) {
                self.machine.event(Event::JointLimit(number));
            }
            if measured.velocity[joint].abs() > self.overspeed[joint] {
                self.machine.event(Event::Overspeed(number));
            }
        }
    }

    /// Acts on a command that was not seen before.
    fn take(&mut self, command: &Command, now_ns: i64) -> Result<(), CommandRefusal> {
        if !self.commands.is_new(command) || self.state() != OperatingState::Enabled {
            return Ok(());
        }
        let bent = self.generators[1].setpoint().position;
        let elbow = Elbow::of(&Vector2::new(0.0, bent));
        match self.commands.check(command, now_ns, elbow) {
            Ok(joints) => {
                for (generator, target) in self.generators.iter_mut().zip(joints) {
                    generator.set_target(target);
                }
                self.last_command_ns = Some(now_ns);
                self.accepted += 1;
                Ok(())
            }
            Err(refusal) => {
                self.refusals.count(&refusal);
                Err(refusal)
            }
        }
    }

    fn watch(&mut self, now_ns: i64) {
        if self
            .last_command_ns
            .is_some_and(|last| now_ns.saturating_sub(last) > self.command_watchdog_ns)
        {
            self.machine.event(Event::CommandSilent);
        }
    }

    fn drive(&mut self, measured: &Measurement, output: &mut ServoOutput) {
        for joint in 0..JOINTS {
            let (position, velocity) = (measured.position[joint], measured.velocity[joint]);
            let generator = &mut self.generators[joint];
            let torque = match self.machine.state() {
                OperatingState::Disabled | OperatingState::Fault => {
                    generator.start(position);
                    LimitedTorque::default()
                }
                OperatingState::Paused => {
                    generator.start(self.hold[joint]);
                    self.laws[joint].hold(self.hold[joint], position, velocity)
                }
                OperatingState::Enabled => {
                    output.velocity_limited |= generator.step(self.period);
                    output.approaching |= generator.is_approaching();
                    let load = measured.torque[joint];
                    self.laws[joint].follow(&generator.setpoint(), position, velocity, load)
                }
            };
            output.torque[joint] = torque.torque;
            output.effort_limited |= torque.limited;
            output.setpoint[joint] = generator.setpoint();
        }
    }
}
