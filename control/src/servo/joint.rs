//! The servo of one joint: its setpoint, its law and its limits.

use super::{
    FeedForward, JointTuning, LimitedTorque, PositionLaw, ServoConfig, Setpoint, SetpointGenerator,
    SetpointLimits,
};
use crate::operating::{Event, OperatingState};
use ferntast_model::joint::JointParameters;
use ferntast_model::{ParameterError, check};

/// What one joint measures.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    /// Motor position \[rad\].
    pub(super) position: f64,
    /// Motor velocity \[rad/s\].
    pub(super) velocity: f64,
    /// Joint torque \[Nm\].
    pub(super) torque: f64,
}

/// What one joint is to do.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Driven {
    /// Motor torque.
    pub(super) torque: LimitedTorque,
    /// The setpoint is at a limit of velocity or acceleration.
    pub(super) velocity_limited: bool,
    /// The setpoint is on its way to the first command.
    pub(super) approaching: bool,
}

/// The servo of one joint.
#[derive(Clone, Debug)]
pub(super) struct JointServo {
    law: PositionLaw,
    generator: SetpointGenerator,
    /// Where it was paused [rad].
    hold: f64,
    limits: [f64; 2],
    limit_margin: f64,
    /// Measured positions outside this are a fault [rad].
    fault_range: [f64; 2],
    overspeed: f64,
}

impl JointServo {
    pub(super) fn new(
        joint: &JointParameters,
        tuning: &JointTuning,
        config: &ServoConfig,
    ) -> Result<JointServo, ParameterError> {
        joint.validate()?;
        let share = config.approach_speed / joint.velocity_limit;
        check("approach_speed / velocity_limit", share, 0.0, 1.0, "-")?;
        let limits = [joint.position_lower, joint.position_upper];
        Ok(JointServo {
            law: PositionLaw::new(joint, tuning, config)?,
            generator: SetpointGenerator::new(
                config.tracker_frequency,
                SetpointLimits {
                    velocity: config.velocity_share * joint.velocity_limit,
                    acceleration: tuning.acceleration_limit,
                    approach: config.approach_speed,
                    lower: joint.position_lower,
                    upper: joint.position_upper,
                },
            ),
            hold: 0.0,
            limits,
            limit_margin: config.limit_margin,
            fault_range: limits,
            overspeed: config.overspeed_share * joint.velocity_limit,
        })
    }

    pub(super) fn feed_forward(&self) -> &FeedForward {
        self.law.feed_forward()
    }

    pub(super) fn feed_forward_mut(&mut self) -> &mut FeedForward {
        self.law.feed_forward_mut()
    }

    pub(super) fn setpoint(&self) -> Setpoint {
        self.generator.setpoint()
    }

    pub(super) fn set_target(&mut self, target: f64) {
        self.generator.set_target(target);
    }

    /// Starts from `position` \[rad\]. A joint that stands outside its limits may
    /// be brought back: only further out is a fault then.
    pub(super) fn start(&mut self, position: f64) {
        self.generator.start(position);
        let ([lower, upper], margin) = (self.limits, self.limit_margin);
        self.fault_range = [position.min(lower) - margin, position.max(upper) + margin];
    }

    /// Where to be while paused \[rad\].
    pub(super) fn hold_at(&mut self, position: f64) {
        self.hold = position;
    }

    /// What is wrong with what joint number `number` (from 1) measures.
    pub(super) fn faults(&self, number: u8, seen: &Seen) -> impl Iterator<Item = Event> {
        let [lower, upper] = self.fault_range;
        let outside = !(lower..=upper).contains(&seen.position);
        let too_fast = seen.velocity.abs() > self.overspeed;
        let outside = outside.then_some(Event::JointLimit(number));
        let too_fast = too_fast.then_some(Event::Overspeed(number));
        outside.into_iter().chain(too_fast)
    }

    /// One step of `dt` \[s\].
    pub(super) fn drive(&mut self, state: OperatingState, dt: f64, seen: &Seen) -> Driven {
        let (position, velocity) = (seen.position, seen.velocity);
        match state {
            OperatingState::Disabled | OperatingState::Fault => {
                self.generator.start(position);
                Driven::default()
            }
            OperatingState::Paused => {
                self.generator.start(self.hold);
                Driven {
                    torque: self.law.hold(self.hold, position, velocity),
                    ..Driven::default()
                }
            }
            OperatingState::Enabled => {
                let velocity_limited = self.generator.step(dt);
                let setpoint = self.generator.setpoint();
                Driven {
                    torque: self.law.follow(&setpoint, position, velocity, seen.torque),
                    velocity_limited,
                    approaching: self.generator.is_approaching(),
                }
            }
        }
    }
}
