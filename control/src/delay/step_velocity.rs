//! The hand's velocity as its port has it.

use super::Motion;
use nalgebra::Vector3;

/// Velocity of the hand over the last step. Not the filtered one: one that lags would let the
/// port give out energy.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct StepVelocity {
    /// Of the hand at the last step [m].
    position: Option<Vector3<f64>>,
}

impl StepVelocity {
    /// Over a step of `dt` \[s\] that brought the hand here; at the first one what was measured
    /// \[m/s\].
    pub fn step(&mut self, dt: f64, hand: &Motion) -> Vector3<f64> {
        let here = Vector3::from(hand.position);
        match self.position.replace(here) {
            Some(before) if dt > 0.0 => (here - before) / dt,
            _ => hand.velocity.into(),
        }
    }

    /// The hand is not measured.
    pub fn forget(&mut self) {
        self.position = None;
    }
}
