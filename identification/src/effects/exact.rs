//! Channels that pass the column filter of a fit as they are, made of measured signals.

use ferntast_model::friction::Exact;

/// A signal that an [`Exact`] channel is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExactSignal {
    /// q.
    Position,
    /// τ, measured.
    JointTorque,
}

/// What `channel` is where no signal takes part.
pub(crate) fn constant_of(channel: Exact) -> f64 {
    f64::from(u8::from(channel == Exact::One))
}

/// Signals, the order of their derivative, and factors that add up to `channel`;
/// `inertia` is J.
pub(crate) fn parts_of(
    channel: Exact,
    inertia: f64,
) -> impl Iterator<Item = (ExactSignal, u8, f64)> {
    use ExactSignal::{JointTorque, Position};
    let (first, second) = match channel {
        Exact::One => (None, None),
        Exact::Position => (Some((Position, 0, 1.0)), None),
        Exact::Velocity => (Some((Position, 1, 1.0)), None),
        Exact::Acceleration => (Some((Position, 2, 1.0)), None),
        Exact::JointTorque => (Some((JointTorque, 0, 1.0)), None),
        Exact::JointTorqueRate => (Some((JointTorque, 1, 1.0)), None),
        Exact::Driven => (Some((JointTorque, 0, 1.0)), Some((Position, 2, inertia))),
    };
    first.into_iter().chain(second)
}
