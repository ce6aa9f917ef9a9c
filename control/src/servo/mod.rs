//! The follower's 1 kHz joint servo with CRTK operating states.
//!
//! One call of [`Servo::step`] a period: measurement, newest command and state
//! command in; motor torques, setpoint, state and everything refused or
//! limited out. It has the joints that it is made for, one to
//! [`MAX_JOINTS`](ferntast_model::MAX_JOINTS); the arm itself it needs only
//! to be told tips and to stop at what it runs into. What a serial arm's links weigh, and what
//! their motion takes, is fed forward.
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
//! within 5 ms; but after more than 10 ms of it the arm is no longer where it was
//! commanded to be, and what it is commanded then counts as a first command. It stands
//! until then, and waits as long as for any other command.

mod command;
mod compliance;
mod config;
mod contact_stop;
mod feed_forward;
mod frozen;
mod joint;
mod jumped;
mod law;
mod planar_tip;
mod release;
mod serial;
mod serial_tip;
mod setpoint;
mod stall;
mod take_over;
#[cfg(test)]
mod tests;
mod tip;
mod turning;

pub use command::{
    CLOCK_TOLERANCE, CartesianModel, Command, CommandCheck, CommandRefusal, Range, RefusalCounts,
    Target,
};
pub use compliance::{stiffest, stiffest_serial, tip_compliance};
pub use config::{JointTuning, ReleaseConfig, ServoConfig};
pub use contact_stop::ContactStopConfig;
pub use feed_forward::{FedForward, FedTorque, FeedForward, MAX_TERMS};
pub use law::{LimitedTorque, PositionLaw};
pub use setpoint::{Setpoint, SetpointGenerator, SetpointLimits};
pub use take_over::{FoundParameter, LeftOut, TakeOverConfig, TakeOverRefusal, TakenOver};

use self::contact_stop::ContactStop;
use self::frozen::FrozenWatch;
use self::joint::{JointServo, Seen};
use self::jumped::JumpWatch;
use self::serial::Carried;
use self::stall::Stall;
use crate::operating::{Event, OperatingState, Reason, StateCommand, StateMachine, StateRefusal};
use crate::planted::{Planted, Rule};
use crate::{nanoseconds, seconds};
use ferntast_model::arm::{Arm, ArmParameters};
use ferntast_model::joint::JointParameters;
use ferntast_model::kinematics::planar;
use ferntast_model::serial_arm::SerialArm;
use ferntast_model::{JointCount, Joints, ParameterError};

/// A torque that is older than this counts no more: the arm's node lets go of the drives \[s\].
/// A servo that was held up for longer begins where the arm is, as other hands may have moved
/// it.
pub const TORQUE_LIFE: f64 = 0.010;

/// After the servo was held up a measurement is of the time after that when it is not
/// older than this \[periods\].
const MEASURED_AFTER: f64 = 3.0;

/// What the arm measures, on the joint side of the gear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// When it was measured \[ns since the UNIX epoch\].
    pub stamp_ns: i64,
    /// Motor positions \[rad\].
    pub position: Joints<f64>,
    /// Motor velocities \[rad/s\].
    pub velocity: Joints<f64>,
    /// Joint torques \[Nm\]; zeros when there is no sensor.
    pub torque: Joints<f64>,
}

impl Measurement {
    /// How old it is at `now_ns` \[ns\].
    fn age_ns(&self, now_ns: i64) -> i64 {
        now_ns.saturating_sub(self.stamp_ns)
    }

    /// Whether it is a measurement of so many joints.
    fn is_of(&self, count: JointCount) -> bool {
        [&self.position, &self.velocity, &self.torque]
            .into_iter()
            .all(|own| own.count() == count && own.iter().all(|value| value.is_finite()))
    }

    /// What each joint measures, of which `weight` \[Nm\] is the arm's own; `None` where that is
    /// not known: then a paused arm keeps what it presses with.
    fn joints(&self, weight: Option<Joints<f64>>) -> impl Iterator<Item = Seen> + '_ {
        let both = self.position.iter().zip(self.velocity.iter());
        let all = both.zip(self.torque.iter()).enumerate();
        all.map(move |(joint, ((&position, &velocity), &torque))| Seen {
            position,
            velocity,
            torque,
            external: weight
                .and_then(|own| own.get(joint).copied())
                .map_or(0.0, |own| torque - own),
        })
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
    pub torque: Joints<f64>,
    /// Where the joints should be.
    pub setpoint: Joints<Setpoint>,
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
    count: JointCount,
    /// As many as there are joints.
    joints: Vec<JointServo>,
    last_command_ns: Option<i64>,
    stall: Stall,
    /// The servo has not begun again since it was held up.
    was_held_up: bool,
    frozen: FrozenWatch,
    jumped: JumpWatch,
    /// The most that the motors give \[Nm\].
    torque_limits: Joints<f64>,
    /// What is a fault, of each joint \[rad/s\].
    overspeed: Joints<f64>,
    refusals: RefusalCounts,
    accepted: u64,
    /// What the joints carry of a serial arm's links.
    carried: Option<Carried>,
    /// The links of a planar arm.
    planar: Option<Arm>,
    contact_stop: Option<ContactStop>,
    planted: Planted,
}

impl Servo {
    /// A servo for `joints` as they are believed to be, of whatever arm: it takes joint
    /// positions only.
    ///
    /// # Errors
    ///
    /// The first value of `config` or of the joints that is out of bounds; a list
    /// of `config` of another number of joints.
    pub fn new(joints: &[JointParameters], config: &ServoConfig) -> Result<Servo, ParameterError> {
        Servo::of(joints, CartesianModel::None, config)
    }

    /// A servo for a planar arm of those `links`: it takes tips as well as joint positions, and
    /// stops at what it runs into where `config` says so.
    ///
    /// # Errors
    ///
    /// As [`Servo::new`]; another number of joints than of links.
    pub fn planar(
        joints: &[JointParameters],
        links: &ArmParameters,
        config: &ServoConfig,
    ) -> Result<Servo, ParameterError> {
        let links = Arm::new(links);
        let kinematics = CartesianModel::Planar(*links.kinematics());
        let servo = Servo::of(joints, kinematics, config)?;
        Ok(Servo {
            planar: Some(links),
            ..servo
        })
    }

    /// A servo for a serial `arm` in space: it takes tips as well as joint positions, and
    /// carries the links' weight and what their motion takes.
    ///
    /// # Errors
    ///
    /// As [`Servo::new`].
    pub fn serial(arm: &SerialArm, config: &ServoConfig) -> Result<Servo, ParameterError> {
        let servo = Servo::of(arm.joints(), CartesianModel::Serial(arm), config)?;
        Ok(Servo {
            carried: Some(Carried::new(arm, &config.joints(servo.count)?)),
            ..servo
        })
    }

    fn of(
        joints: &[JointParameters],
        kinematics: CartesianModel<'_>,
        config: &ServoConfig,
    ) -> Result<Servo, ParameterError> {
        config.validate()?;
        let count = JointCount::new(joints.len())?;
        let tuning = config.joints(count)?;
        let limits = |joint: usize| [joints[joint].position_lower, joints[joint].position_upper];
        let limits = Joints::from_fn(count, limits);
        let stops = config.contact_stop.torque > 0.0;
        let contact_stop = stops.then(|| ContactStop::new(joints, count, &config.contact_stop));
        let each = joints.iter().zip(tuning.iter()).enumerate();
        let each = each.map(|(index, (joint, tuning))| {
            JointServo::new(joint, tuning, config)
                .map_err(|error| error.within(&format!("joint[{index}]")))
        });
        let joints = each.collect::<Result<Vec<_>, _>>()?;
        Ok(Servo {
            period: config.period,
            command_watchdog_ns: nanoseconds(config.command_watchdog),
            measurement_watchdog_ns: nanoseconds(config.measurement_watchdog),
            machine: StateMachine::default(),
            commands: CommandCheck::new(kinematics, limits, config)?,
            count,
            torque_limits: Joints::from_fn(count, |joint| joints[joint].torque_limit()),
            overspeed: Joints::from_fn(count, |joint| joints[joint].overspeed()),
            joints,
            last_command_ns: None,
            stall: Stall::default(),
            was_held_up: false,
            frozen: FrozenWatch::default(),
            jumped: JumpWatch::default(),
            refusals: RefusalCounts::default(),
            accepted: 0,
            carried: None,
            planar: None,
            contact_stop,
            planted: Planted::NONE,
        })
    }

    /// The same with a planted bug.
    pub fn planted(mut self, planted: Planted) -> Servo {
        self.machine = self.machine.planted(planted);
        self.stall.planted = planted;
        self.frozen.planted = planted;
        self.jumped.planted = planted;
        let joints = self.joints.into_iter();
        self.joints = joints.map(|joint| joint.planted(planted)).collect();
        self.planted = planted;
        self
    }

    /// How many joints it moves.
    pub fn joints(&self) -> JointCount {
        self.count
    }

    /// The operating state.
    pub fn state(&self) -> OperatingState {
        self.machine.state()
    }

    /// The friction that is fed forward at each joint.
    pub fn feed_forward(&self) -> impl Iterator<Item = &FeedForward> {
        self.joints.iter().map(JointServo::feed_forward)
    }

    /// The same at joint number `joint` (from 0), to be told other friction.
    pub fn feed_forward_mut(&mut self, joint: usize) -> Option<&mut FeedForward> {
        let own = self.joints.get_mut(joint);
        own.map(JointServo::feed_forward_mut)
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
        if self.stall.has_just_ended(TORQUE_LIFE) && !self.planted.lacks(Rule::BeginAfterStall) {
            self.was_held_up = true;
            // It stands: those who were held up as well have the time of a watchdog to be heard.
            self.last_command_ns = self.last_command_ns.map(|_| now_ns);
        }
        // What was said while the servo was held up is not where the arm is to go now.
        let listens = !self.was_held_up;
        for joint in &mut self.joints {
            joint.feed_forward_mut().step(self.period);
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
                if self.state() == OperatingState::Enabled {
                    let fresh = self.is_fresh(measured, now_ns);
                    if was != OperatingState::Enabled {
                        self.last_command_ns = None;
                        self.was_held_up = !fresh;
                        if was != OperatingState::Paused {
                            self.commands.begin();
                        }
                        self.begin(measured);
                    } else if self.was_held_up || self.is_stale(measured, now_ns) {
                        // Until it is measured again: where it was measured last.
                        self.begin(measured);
                        self.was_held_up = !fresh;
                    }
                }
                self.supervise(measured);
            }
        }
        let refused = input.command.and_then(|command| {
            self.take(&command, now_ns, listens && !self.was_held_up)
                .err()
        });
        self.watch(now_ns - stalled_ns);
        if was == OperatingState::Enabled
            && self.state() == OperatingState::Paused
            && let Ok(measured) = &measurement
        {
            for (joint, position) in self.joints.iter_mut().zip(measured.position.iter()) {
                joint.hold_at(*position);
            }
        }

        let mut output = ServoOutput {
            torque: Joints::filled(self.count, 0.0),
            setpoint: Joints::filled(self.count, Setpoint::default()),
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
                .map_or(f64::NAN, |own| seconds(own.age_ns(now_ns))),
        };
        match measurement {
            Ok(measured) => {
                let carried = self.carried.as_ref();
                let posture = carried.map(|own| own.posture(&measured.position));
                let weight = match &posture {
                    Some((_, weight)) => Some(*weight),
                    None => self.planar_weight(&measured.position),
                };
                self.drive(&measured, weight, &mut output);
                if let (Some(carried), Some(posture)) = (&self.carried, posture) {
                    let setpoint = self.setpoint();
                    carried.add(&measured, &posture, &setpoint, &mut output);
                }
            }
            Err(_) => self.joints.iter_mut().for_each(JointServo::let_go),
        }
        output.setpoint = self.setpoint();
        output
    }

    /// The measurement, when it can be used.
    fn usable(&self, now_ns: i64, newest: Option<&Measurement>) -> Result<Measurement, Event> {
        let Some(measured) = newest else {
            return Err(Event::MeasurementSilent);
        };
        let silent = measured.age_ns(now_ns) > self.measurement_watchdog_ns
            && !self.planted.lacks(Rule::MeasurementWatchdog);
        if measured.stamp_ns <= 0 || silent {
            return Err(Event::MeasurementSilent);
        }
        if !measured.is_of(self.count) {
            return Err(Event::MeasurementInvalid);
        }
        Ok(*measured)
    }

    /// Whether it was measured after the servo was held up.
    fn is_fresh(&self, measured: &Measurement, now_ns: i64) -> bool {
        measured.age_ns(now_ns) <= nanoseconds(MEASURED_AFTER * self.period)
    }

    /// Whether it was measured so long ago that the arm is not where it was any more: who
    /// measures it drives it, too, and lets go of the drives meanwhile.
    fn is_stale(&self, measured: &Measurement, now_ns: i64) -> bool {
        measured.age_ns(now_ns) > nanoseconds(TORQUE_LIFE)
            && !self.planted.lacks(Rule::BeginAfterStall)
    }

    /// Starts from where the arm is.
    fn begin(&mut self, measured: &Measurement) {
        self.commands.rearm();
        for (joint, position) in self.joints.iter_mut().zip(measured.position.iter()) {
            joint.start(*position);
        }
    }

    fn supervise(&mut self, measured: &Measurement) {
        let given = Joints::from_fn(self.count, |joint| self.joints[joint].motor_torque());
        let frozen = self.frozen.step(measured, given, &self.torque_limits);
        let jumped = self.jumped.step(measured, &self.overspeed);
        let driven = [OperatingState::Enabled, OperatingState::Paused].contains(&self.state());
        let frozen = frozen.map(Event::MeasurementFrozen);
        for event in frozen
            .into_iter()
            .chain(jumped.map(Event::MeasurementJumped))
        {
            if driven {
                self.machine.event(event);
            }
        }
        for (number, (joint, seen)) in (1..).zip(self.joints.iter().zip(measured.joints(None))) {
            for event in joint.faults(number, &seen) {
                self.machine.event(event);
            }
        }
    }

    /// Acts on a command that was not seen before.
    fn take(
        &mut self,
        command: &Command,
        now_ns: i64,
        listens: bool,
    ) -> Result<(), CommandRefusal> {
        if !self.commands.is_new(command) {
            return Ok(());
        }
        self.machine.heard();
        if self.state() != OperatingState::Enabled {
            return Ok(());
        }
        let posture = self.setpoint().map(|own| own.position);
        if !listens {
            // It is not followed and nothing is remembered of it; but who says what could be
            // followed is not silent.
            if self.commands.judge(command, now_ns, &posture).is_ok() {
                let made_ns = command.stamp_ns.min(now_ns);
                self.last_command_ns = self.last_command_ns.map(|last| last.max(made_ns));
            }
            return Ok(());
        }
        match self.commands.check(command, now_ns, &posture) {
            Ok(targets) => {
                let targets = match &self.carried {
                    Some(carried) => carried.motor_positions(&targets),
                    None => targets,
                };
                for (joint, target) in self.joints.iter_mut().zip(targets.iter()) {
                    joint.set_target(*target);
                }
                // From when it was made, not from when it got here.
                self.last_command_ns = Some(command.stamp_ns.min(now_ns));
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
            && !self.planted.lacks(Rule::CommandWatchdog)
        {
            self.machine.event(Event::CommandSilent);
        }
    }

    fn setpoint(&self) -> Joints<Setpoint> {
        Joints::from_fn(self.count, |joint| self.joints[joint].setpoint())
    }

    /// What the joints of a planar arm carry of its links' weight at `position` \[rad\], in Nm.
    fn planar_weight(&self, position: &Joints<f64>) -> Option<Joints<f64>> {
        let links = self.planar.as_ref()?;
        planar(position).map(|q| links.gravity(&q).into())
    }

    /// Whether the arm has just run into something that its torque sensors feel.
    fn runs_into_something(&mut self, measured: &Measurement) -> bool {
        let Some(stop) = &mut self.contact_stop else {
            return false;
        };
        if !self.joints.iter().all(JointServo::is_following) {
            // On its way to the first command it is slow, and its torque is led over.
            stop.rest();
        }
        let (joints, period) = (&self.joints, self.period);
        let velocity = Joints::from_fn(self.count, |joint| joints[joint].setpoint().velocity);
        match (&self.planar, &self.carried) {
            (Some(links), _) => stop.step(links, period, measured, &velocity),
            (None, Some(carried)) => stop.step(carried.arm(), period, measured, &velocity),
            (None, None) => false,
        }
    }

    fn drive(
        &mut self,
        measured: &Measurement,
        weight: Option<Joints<f64>>,
        output: &mut ServoOutput,
    ) {
        let state = self.machine.state();
        let times = self.joints.iter().map(JointServo::time_left);
        let slowest = times.fold(0.0, f64::max);
        let stands = self.runs_into_something(measured);
        for own in &mut self.joints {
            own.keep_pace(slowest);
            own.stand(stands);
        }
        let joints = self.joints.iter_mut().zip(measured.joints(weight));
        for (torque, (joint, seen)) in output.torque.iter_mut().zip(joints) {
            let driven = joint.drive(state, self.period, &seen);
            *torque = driven.torque.torque;
            output.effort_limited |= driven.torque.limited;
            output.velocity_limited |= driven.velocity_limited;
            output.approaching |= driven.approaching;
        }
        if output.approaching && self.joints.iter().all(JointServo::is_near) {
            self.joints.iter_mut().for_each(JointServo::end_approach);
        }
    }
}
