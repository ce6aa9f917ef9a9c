//! Joint position law.
//!
//! τ_m = [k_P (q_d − q)] + k_D (q̇_d − q̇) + J q̈_d + c τ_F(q̇_d)
//!
//! with the bracket limited: a setpoint far behind a surface presses with that
//! much torque and no more. All on the motor side of the elasticity, after equation (2): motor inertia and
//! friction are fed forward from the *setpoint*, so that neither measurement
//! noise nor stiction chatter gets in. Feedback from the motor alone keeps
//! actuator and sensor collocated, and the loop passive towards the links and
//! what they touch (Spong 1987; Albu-Schäffer, Ott, Hirzinger 2007).
//!
//! While paused it is k_P (q_0 − q) − k_D q̇: a spring to where the arm was and a
//! damper. A sampled spring and damper inject no energy as long as
//! b > K T/2 + |B| (Colgate and Schenkel 1997), with b the joint's own viscous
//! friction: about 165 Nm·s/rad against 1000 · 0.001 / 2 + 40.

use super::{FeedForward, JointTuning, ServoConfig, Setpoint};
use crate::planted::{Planted, Rule};
use ferntast_model::ParameterError;
use ferntast_model::joint::JointParameters;

/// Time constant with which a braked motor comes to rest [s].
const BRAKED: f64 = 0.005;

/// Position law of one joint.
#[derive(Clone, Debug)]
pub struct PositionLaw {
    friction: FeedForward,
    inertia: f64,
    stiffness: f64,
    pressing_limit: f64,
    damping: f64,
    hold_stiffness: f64,
    hold_damping: f64,
    torque_limit: f64,
    compensation: f64,
    smoothing: f64,
    pub(super) planted: Planted,
}

/// A motor torque, and whether it was limited.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LimitedTorque {
    /// τ_m, joint side \[Nm\].
    pub torque: f64,
    /// It would have been more.
    pub limited: bool,
}

impl PositionLaw {
    /// The law of one joint.
    ///
    /// # Errors
    ///
    /// When the joint's friction is not what the model knows.
    pub fn new(
        joint: &JointParameters,
        tuning: &JointTuning,
        config: &ServoConfig,
    ) -> Result<PositionLaw, ParameterError> {
        Ok(PositionLaw {
            friction: FeedForward::new(joint, config.take_over)?,
            inertia: joint.motor_inertia,
            stiffness: tuning.stiffness,
            pressing_limit: tuning.pressing_limit,
            damping: tuning.damping,
            hold_stiffness: tuning.hold_stiffness,
            hold_damping: tuning.hold_damping,
            torque_limit: joint.motor_torque_limit,
            compensation: config.friction_compensation,
            smoothing: config.friction_smoothing,
            planted: Planted::NONE,
        })
    }

    /// The friction that is fed forward.
    pub fn feed_forward(&self) -> &FeedForward {
        &self.friction
    }

    /// The same, to be told other friction.
    pub fn feed_forward_mut(&mut self) -> &mut FeedForward {
        &mut self.friction
    }

    /// How far a joint is behind its setpoint when it presses as hard as it may \[rad\].
    pub(super) fn reach(&self) -> f64 {
        self.pressing_limit / self.stiffness
    }

    /// Motor torque that follows `setpoint`, from motor position \[rad\],
    /// velocity \[rad/s\] and joint torque \[Nm\] (0 when not known). A motor that is `braked` comes
    /// to rest at a setpoint that stands within milliseconds.
    pub fn follow(
        &self,
        setpoint: &Setpoint,
        position: f64,
        velocity: f64,
        load: f64,
        braked: bool,
    ) -> LimitedTorque {
        let braking = if braked { self.inertia / BRAKED } else { 0.0 };
        let pressing = self.stiffness * (setpoint.position - position);
        let limited = pressing.abs() > self.pressing_limit;
        let bounded = match self.planted.lacks(Rule::PressingLimit) {
            true => pressing,
            false => pressing.clamp(-self.pressing_limit, self.pressing_limit),
        };
        let feedback = bounded + (self.damping + braking) * (setpoint.velocity - velocity);
        let feed_forward = self.inertia * setpoint.acceleration + self.friction(setpoint, load);
        let torque = self.limit(feedback + feed_forward);
        LimitedTorque {
            limited: torque.limited || limited,
            ..torque
        }
    }

    /// Motor torque that holds passively at `hold` \[rad\].
    pub fn hold(&self, hold: f64, position: f64, velocity: f64) -> LimitedTorque {
        self.limit(self.hold_stiffness * (hold - position) - self.hold_damping * velocity)
    }

    /// c τ_F at the setpoint. Below the smoothing speed what goes with the motion
    /// goes linearly through zero: no step when the setpoint turns.
    fn friction(&self, setpoint: &Setpoint, load: f64) -> f64 {
        let speed = setpoint.velocity.abs();
        let velocity = speed.max(self.smoothing).copysign(setpoint.velocity);
        let fade = (speed / self.smoothing).min(1.0);
        let torque = self.friction.torque(setpoint.position, velocity, load);
        self.compensation * fade * torque.sliding + self.compensation * torque.standing
    }

    fn limit(&self, torque: f64) -> LimitedTorque {
        // NaN would pass `clamp`: an undefined torque is no torque.
        if !torque.is_finite() {
            return LimitedTorque {
                torque: 0.0,
                limited: true,
            };
        }
        let bounded = match self.planted.lacks(Rule::TorqueLimit) {
            true => torque,
            false => torque.clamp(-self.torque_limit, self.torque_limit),
        };
        LimitedTorque {
            torque: bounded,
            limited: torque.abs() > self.torque_limit,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::servo::tests::joint;
    use ferntast_model::JointCount;

    /// Without friction, the setpoint where it is: v = v₀ exp(−t (1/5 ms + k_D/J)).
    #[test]
    fn a_motor_that_is_braked_comes_to_rest_within_milliseconds() {
        let (config, joint) = (ServoConfig::default(), joint());
        let tuning = config.joints(JointCount::new(2).unwrap()).unwrap()[0];
        let law = PositionLaw::new(&joint, &tuning, &config).unwrap();
        let (dt, begun) = (1e-5, 0.1);
        let mut velocity = begun;
        for _ in 0..500 {
            let torque = law.follow(&Setpoint::default(), 0.0, velocity, 0.0, true);
            assert!(!torque.limited);
            velocity += torque.torque / joint.motor_inertia * dt;
        }
        let expected = (-0.005 * (1.0 / 0.005 + tuning.damping / joint.motor_inertia)).exp();
        assert!(
            (velocity / begun / expected - 1.0_f64).abs() < 0.01,
            "{velocity}"
        );
    }
}
