//! Sensors that are stuck at one value.

use super::{Flag, TwinSample};

/// Smallest range of the motor torque, as a share of its size, over which an exactly
/// constant position is stuck rather than at rest \[1\].
const TORQUE_SHARE: f64 = 2.0;
/// Smallest range of the position, as a share of the travel in the recordings, over
/// which an exactly constant joint torque is stuck \[1\].
const TRAVEL_SHARE: f64 = 0.05;

/// Detects stuck sensors of position and joint torque.
#[derive(Clone, Debug)]
pub(super) struct Sensors {
    /// Range of motor torque \[Nm\] in which a joint can be at rest.
    torque: f64,
    /// Range of position \[rad\] within which a joint torque can be the same.
    travel: f64,
    position: Still,
    joint_torque: Still,
}

/// A value that has not changed, and the range of another since.
#[derive(Clone, Copy, Debug, Default)]
struct Still {
    value: Option<f64>,
    low: f64,
    high: f64,
}

impl Sensors {
    /// For motor torques of rms `torque` \[Nm\] and a `travel` \[rad\].
    pub(super) fn new(torque: f64, travel: f64) -> Self {
        Self {
            torque: TORQUE_SHARE * torque,
            travel: TRAVEL_SHARE * travel,
            position: Still::default(),
            joint_torque: Still::default(),
        }
    }

    pub(super) fn restart(&mut self) {
        self.position = Still::default();
        self.joint_torque = Still::default();
    }

    /// Which sensor is stuck, if one is.
    pub(super) fn stuck(&mut self, sample: &TwinSample) -> Option<Flag> {
        let torque_range = self.position.range(sample.position, sample.motor_torque);
        if torque_range > self.torque {
            return Some(Flag::PositionStuck);
        }
        let joint_torque = sample.joint_torque?;
        let travelled = self.joint_torque.range(joint_torque, sample.position);
        (travelled > self.travel).then_some(Flag::JointTorqueStuck)
    }
}

impl Still {
    /// Range of `other` for as long as `value` has been the same.
    fn range(&mut self, value: f64, other: f64) -> f64 {
        if self.value == Some(value) {
            self.low = self.low.min(other);
            self.high = self.high.max(other);
        } else {
            *self = Self {
                value: Some(value),
                low: other,
                high: other,
            };
        }
        self.high - self.low
    }
}
