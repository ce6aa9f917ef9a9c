//! An arm behind the servo that ships, and an operator who arms it.
//!
//! Each part takes what the others gave a tick ago, as nodes of a session do: from a
//! measurement to the link's end 2 ms, from its command to the drives 2 ms.

use super::TICK;
use super::follower::{Follower, TipCommand, TrueTip};
use ferntast_control::link::{FollowerReadings, StampedPosition};
use ferntast_control::operating::{OperatingState, StateCommand};
use ferntast_control::servo::{Command, Measurement, Servo, ServoInput, Target};
use ferntast_model::Joints;

/// The operator says `resume` so long after the arm paused [ns].
const RESUME_AFTER_NS: i64 = 500_000_000;

/// An arm with its estimator and with what it touches, of any kind.
pub trait TrialArm {
    /// Lets a tick pass with these torques of the motors \[Nm\]; the surface began to move
    /// `since` \[s\] ago.
    fn advance(&mut self, since: f64, torque: &Joints<f64>);
    /// Reads its sensors; `None` where they give nothing.
    fn measure(&mut self, now_ns: i64) -> Option<Measurement>;
    /// Temperatures of its gears \[degC\], where they are measured.
    fn temperature(&self) -> Option<Joints<f64>>;
    /// What the estimator makes of the measurement before the last one that was read.
    fn estimate(&mut self, measured: &Measurement) -> Estimated;
    /// What is true now.
    fn truth(&self) -> TrueTip;
}

/// What is estimated of the tip, base frame.
#[derive(Clone, Copy, Debug)]
pub struct Estimated {
    /// \[m\]; `None` without a measurement.
    pub tip: Option<[f64; 3]>,
    /// Of the contact, as laws take it \[N\].
    pub force: Option<[f64; 3]>,
}

/// The arm, from its motors to what the link's end is told.
pub(super) struct Servoed<A> {
    arm: A,
    servo: Servo,
    torque: Joints<f64>,
    /// Of one tick ago.
    measured: Option<Measurement>,
    /// Of one tick ago.
    command: Option<Command>,
    /// When the arm was left not enabled [ns].
    stopped_ns: Option<i64>,
    state: OperatingState,
    readings: FollowerReadings,
}

impl<A: TrialArm> Servoed<A> {
    pub(super) fn new(arm: A, servo: Servo) -> Servoed<A> {
        Servoed {
            arm,
            torque: Joints::filled(servo.joints(), 0.0),
            servo,
            measured: None,
            command: None,
            stopped_ns: None,
            state: OperatingState::Disabled,
            readings: FollowerReadings {
                tip: None,
                contact_force: None,
                state: OperatingState::Disabled,
                told_to_stop: false,
            },
        }
    }

    /// What the operator says: enable at the start, and resume a while after each stop.
    fn word(&mut self, now_ns: i64) -> Option<StateCommand> {
        match self.state {
            OperatingState::Enabled => {
                self.stopped_ns = None;
                None
            }
            OperatingState::Disabled => Some(StateCommand::Enable),
            _ => {
                let since_ns = *self.stopped_ns.get_or_insert(now_ns);
                (now_ns - since_ns >= RESUME_AFTER_NS).then(|| {
                    self.stopped_ns = None;
                    StateCommand::Resume
                })
            }
        }
    }

    fn drive(&mut self, now_ns: i64) {
        let input = ServoInput {
            measurement: self.measured,
            command: self.command,
            state_command: self.measured.and_then(|_| self.word(now_ns)),
        };
        let output = self.servo.step(now_ns, &input);
        self.state = output.state;
        self.torque = output.torque;
    }

    fn estimate(&mut self, measured: &Measurement) -> FollowerReadings {
        let estimated = self.arm.estimate(measured);
        FollowerReadings {
            tip: estimated.tip.map(|position| StampedPosition {
                stamp_ns: measured.stamp_ns,
                position,
                silence: TICK,
            }),
            contact_force: estimated.force,
            state: self.state,
            told_to_stop: false,
        }
    }
}

impl<A: TrialArm> Follower for Servoed<A> {
    fn step(&mut self, now_ns: i64, since: f64, command: Option<TipCommand>) {
        self.arm.advance(since, &self.torque);
        self.drive(now_ns);
        if let Some(measured) = self.measured {
            self.readings = self.estimate(&measured);
        }
        self.measured = self.arm.measure(now_ns);
        for (joint, temperature) in self.arm.temperature().into_iter().flatten().enumerate() {
            self.servo.set_temperature(joint, temperature);
        }
        if let Some(command) = command {
            self.command = Some(Command {
                stamp_ns: command.made_ns,
                target: Target::Tip(command.position),
            });
        }
    }

    fn truth(&self) -> TrueTip {
        self.arm.truth()
    }

    fn readings(&self) -> FollowerReadings {
        self.readings
    }
}

impl<A: TrialArm + ?Sized> TrialArm for &mut A {
    fn advance(&mut self, since: f64, torque: &Joints<f64>) {
        (**self).advance(since, torque);
    }

    fn measure(&mut self, now_ns: i64) -> Option<Measurement> {
        (**self).measure(now_ns)
    }

    fn temperature(&self) -> Option<Joints<f64>> {
        (**self).temperature()
    }

    fn estimate(&mut self, measured: &Measurement) -> Estimated {
        (**self).estimate(measured)
    }

    fn truth(&self) -> TrueTip {
        (**self).truth()
    }
}
