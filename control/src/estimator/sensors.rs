//! Whether the torque sensors can be believed.

use super::JointMeasurement;
use ferntast_model::joint::JointParameters;
use ferntast_model::{JointCount, Joints};

/// Share of the torque sensor's range that counts as its end.
const SATURATION: f64 = 0.995;

/// A torque that has not changed by one bit while the motor turned this far
/// \[rad\] and for this long \[s\] is not being measured: noise alone would change it.
const STUCK_TRAVEL: f64 = 0.002;
const STUCK_TIME: f64 = 0.1;

/// Watches the torque sensors.
#[derive(Clone, Copy, Debug)]
pub(super) struct SensorWatch {
    unsaturated_for: f64,
    torque: Joints<f64>,
    /// Motor positions when the torques last changed \[rad\].
    position: Joints<f64>,
    /// Time since they last changed \[s\].
    same_for: Joints<f64>,
}

/// What there is to say of the torque sensors.
#[derive(Clone, Copy, Debug)]
pub(super) struct SensorState {
    /// One is, or was within the memory of the filters, at the end of its range.
    pub(super) saturated: bool,
    /// One gives the same number again and again while its joint turns.
    pub(super) stuck: Joints<bool>,
}

impl SensorWatch {
    pub(super) fn new(joints: JointCount) -> Self {
        Self {
            unsaturated_for: f64::INFINITY,
            torque: Joints::filled(joints, f64::NAN),
            position: Joints::filled(joints, 0.0),
            same_for: Joints::filled(joints, 0.0),
        }
    }

    /// Takes in a measurement `dt` \[s\] after the last one, of `joints` as many as
    /// it was made for; filters remember for `memory` \[s\].
    pub(super) fn step(
        &mut self,
        dt: f64,
        memory: f64,
        joints: &[JointParameters],
        measurement: &JointMeasurement,
    ) -> SensorState {
        let mut stuck = Joints::filled(self.torque.count(), false);
        let mut at_end = false;
        for (joint, parameters) in joints.iter().enumerate() {
            let torque = measurement.joint_torque[joint];
            let position = measurement.motor_position[joint];
            at_end |= torque.abs() >= SATURATION * parameters.torque_sensor_range;
            if torque == self.torque[joint] {
                self.same_for[joint] += dt;
            } else {
                self.torque[joint] = torque;
                self.position[joint] = position;
                self.same_for[joint] = 0.0;
            }
            stuck[joint] = self.same_for[joint] >= STUCK_TIME
                && (position - self.position[joint]).abs() >= STUCK_TRAVEL;
        }
        self.unsaturated_for = if at_end {
            0.0
        } else {
            self.unsaturated_for + dt
        };
        SensorState {
            saturated: self.unsaturated_for < memory,
            stuck,
        }
    }
}
