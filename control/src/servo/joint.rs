//! The servo of one joint: its setpoint, its law and its limits.

use super::{
    FeedForward, JointTuning, LimitedTorque, PositionLaw, ServoConfig, Setpoint, SetpointGenerator,
    SetpointLimits, config::ReleaseConfig, release::Release,
};
use crate::operating::{Event, OperatingState};
use crate::planted::{Planted, Rule};
use ferntast_model::joint::JointParameters;
use ferntast_model::{ParameterError, check};

/// After enabling the torque is led over within this time from what the motor gave
/// before [s].
const LEAD_TIME: f64 = 0.05;

/// What one joint measures.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    /// Motor position \[rad\].
    pub(super) position: f64,
    /// Motor velocity \[rad/s\].
    pub(super) velocity: f64,
    /// Joint torque \[Nm\].
    pub(super) torque: f64,
    /// What of it is not the arm's own weight, where that is known \[Nm\].
    pub(super) external: f64,
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
    /// Where it is held while paused [rad].
    hold: f64,
    release: Release,
    release_config: ReleaseConfig,
    /// What the motor gave last [Nm].
    torque: f64,
    /// What it gave when it was enabled, and how far that is led over, 0 … 1.
    before: f64,
    led: f64,
    limits: [f64; 2],
    limit_margin: f64,
    /// Measured positions outside this are a fault [rad].
    fault_range: [f64; 2],
    overspeed: f64,
    torque_limit: f64,
    torque_sensor_range: f64,
    /// The arm has just run into something.
    stands: bool,
    planted: Planted,
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
            release: Release::default(),
            torque: 0.0,
            before: 0.0,
            led: 1.0,
            release_config: config.release,
            limits,
            limit_margin: config.limit_margin,
            fault_range: limits,
            overspeed: config.overspeed_share * joint.velocity_limit,
            torque_limit: joint.motor_torque_limit,
            torque_sensor_range: joint.torque_sensor_range,
            stands: false,
            planted: Planted::NONE,
        })
    }

    /// The same with a planted bug.
    pub(super) fn planted(mut self, planted: Planted) -> JointServo {
        self.law.planted = planted;
        self.generator.planted = planted;
        self.planted = planted;
        self
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

    /// Whether it follows commands, after the way to the first one.
    pub(super) fn is_following(&self) -> bool {
        self.generator.is_following()
    }

    /// Whether its setpoint is where the commands are.
    pub(super) fn is_near(&self) -> bool {
        self.generator.is_near()
    }

    /// How long it takes to the first command at the approach's speed \[s\].
    pub(super) fn time_left(&self) -> f64 {
        self.generator.time_left()
    }

    /// Comes to the first command together with the slowest joint.
    pub(super) fn keep_pace(&mut self, slowest: f64) {
        self.generator.keep_pace(slowest);
    }

    /// The arm has come to the first command.
    pub(super) fn end_approach(&mut self) {
        self.generator.end_approach();
    }

    /// Whether the setpoint stands where it is: the arm has just run into something.
    pub(super) fn stand(&mut self, stands: bool) {
        self.stands = stands;
    }

    pub(super) fn set_target(&mut self, target: f64) {
        self.generator.set_target(target);
    }

    /// Starts from `position` \[rad\]. A joint that stands outside its limits may
    /// be brought back: only further out is a fault then.
    pub(super) fn start(&mut self, position: f64) {
        self.generator.start(position);
        self.release = Release::begin();
        (self.before, self.led) = (self.torque, 0.0);
        let ([lower, upper], margin) = (self.limits, self.limit_margin);
        self.fault_range = [position.min(lower) - margin, position.max(upper) + margin];
    }

    /// The motor is given nothing, as the joint is not measured.
    pub(super) fn let_go(&mut self) {
        self.torque = 0.0;
    }

    /// What the motor was given last \[Nm\].
    pub(super) fn motor_torque(&self) -> f64 {
        self.torque
    }

    /// The most that it gives \[Nm\].
    pub(super) fn torque_limit(&self) -> f64 {
        self.torque_limit
    }

    /// Faster than this is a fault \[rad/s\].
    pub(super) fn overspeed(&self) -> f64 {
        self.overspeed
    }

    /// Where to be while paused \[rad\].
    pub(super) fn hold_at(&mut self, position: f64) {
        self.release = Release::begin();
        if !self.planted.lacks(Rule::HoldWhereMeasured) {
            self.hold = position;
        }
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
        // Beyond its range a sensor says nothing, least of all of friction that goes with it.
        let range = self.torque_sensor_range;
        let seen = Seen {
            torque: seen.torque.clamp(-range, range),
            ..*seen
        };
        let mut driven = self.law(state, dt, &seen);
        if state == OperatingState::Enabled && self.led < 1.0 {
            self.led = (self.led + dt / LEAD_TIME).min(1.0);
            let own = &mut driven.torque.torque;
            *own = (1.0 - self.led) * self.before + self.led * *own;
        }
        self.torque = driven.torque.torque;
        driven
    }

    /// Where to go from `hold`, if it lets go of what it presses against.
    fn give_way(&mut self, hold: f64, dt: f64, seen: &Seen) -> Option<Setpoint> {
        let joint = [seen.position, self.law.reach()];
        self.release
            .step(&self.release_config, dt, hold, joint, seen.external)
    }

    fn law(&mut self, state: OperatingState, dt: f64, seen: &Seen) -> Driven {
        let (position, velocity, load) = (seen.position, seen.velocity, seen.torque);
        match state {
            OperatingState::Disabled | OperatingState::Fault => {
                self.generator.start(position);
                Driven::default()
            }
            OperatingState::Paused => {
                let way_out = self.give_way(self.hold, dt, seen);
                self.hold = way_out.map_or(self.hold, |own| own.position);
                self.generator.start(self.hold);
                let torque = match way_out {
                    Some(setpoint) => self.law.follow(&setpoint, position, velocity, load, false),
                    None => self.law.hold(self.hold, position, velocity),
                };
                Driven {
                    torque,
                    ..Driven::default()
                }
            }
            OperatingState::Enabled => {
                // Nobody feels yet what it presses with.
                let at = self.generator.setpoint().position;
                if self.generator.is_waiting()
                    && let Some(setpoint) = self.give_way(at, dt, seen)
                {
                    self.generator.start(setpoint.position);
                }
                let velocity_limited = match self.stands {
                    true => {
                        self.generator.stand();
                        false
                    }
                    false => self.generator.step(dt),
                };
                let setpoint = self.generator.setpoint();
                let law = &self.law;
                Driven {
                    torque: law.follow(&setpoint, position, velocity, load, self.stands),
                    velocity_limited,
                    approaching: self.generator.is_approaching(),
                }
            }
        }
    }
}
