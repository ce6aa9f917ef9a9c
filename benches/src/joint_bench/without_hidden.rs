//! What the same session would have been without the hidden effects.
//!
//! Equation (2), τ_m = J q̈ + τ + τ_F, holds at every moment. On the same motion
//! and under the same load, what the hidden effects add to the motor torque is
//! therefore their own friction and inertia, and what they make of its reading.
//! Without an elastic transmission or backlash, position is measured where
//! friction acts.
//!
//! All is taken with nominal parameters: what these scatter by between sessions
//! stays, as it does for a model that has one value for all of them.

use super::effect::{Effect, Friction, Reading, State};
use super::parameters::JointParameters;
use super::plant::friction;

/// Follows a session, millisecond by millisecond.
pub(super) struct WithoutHidden<'a> {
    /// With nothing hidden beyond equation (4).
    plain: &'a JointParameters,
    /// The effects once more: these read torques that do not scatter.
    effects: Vec<Box<dyn Effect>>,
    /// Bend of the plain bristles, −1 … 1; none where the true ones are plain.
    bristle: Option<f64>,
    /// Where friction acted last \[rad\].
    position: f64,
}

impl<'a> WithoutHidden<'a> {
    /// At rest at position 0. `effects` of the true `joint` begin a session.
    pub(super) fn new(
        joint: &JointParameters,
        plain: &'a JointParameters,
        effects: &[Box<dyn Effect>],
    ) -> Self {
        WithoutHidden {
            plain,
            effects: effects.iter().map(|effect| effect.boxed()).collect(),
            bristle: (joint.bristle != plain.bristle).then_some(0.0),
            position: 0.0,
        }
    }

    /// How much more than `motor_torque` is read a millisecond later, where
    /// `command` was asked for \[Nm\].
    pub(super) fn misread(&mut self, command: f64, motor_torque: f64) -> f64 {
        let mut reading = Reading {
            motor_torque,
            ..Reading::default()
        };
        for effect in &mut self.effects {
            effect.read(command, &mut reading);
        }
        reading.motor_torque - motor_torque
    }

    /// τ_F \[Nm\] a millisecond later, at `state`.
    pub(super) fn friction(&mut self, state: &State) -> f64 {
        let travel = state.position - self.position;
        self.position = state.position;
        let mut state = *state;
        if let Some(bristle) = &mut self.bristle {
            // Dahl's model, solved over the way of a millisecond.
            let sliding = 1f64.copysign(travel);
            let kept = (-travel.abs() / self.plain.bristle).exp();
            *bristle = sliding + kept * (*bristle - sliding);
            state.bristle = *bristle;
        }
        friction(self.plain, &Friction::default(), 1.0, &state)
    }
}

/// Takes from `motor_torque` \[Nm\] what accelerates the inertia that is hidden, of
/// which `excesses` is Σ J q \[kg m²·rad\], both at each log entry, `period` \[s\] apart. Acceleration is
/// that between entries, as it is for a model: teeth that meet are faster.
pub(super) fn take_inertia(excesses: &[f64], period: f64, motor_torque: &mut [f64]) {
    for (torque, around) in motor_torque.iter_mut().skip(1).zip(excesses.windows(3)) {
        *torque -= (around[0] - 2.0 * around[1] + around[2]) / (period * period);
    }
}
