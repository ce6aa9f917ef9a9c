//! A joint torque sensor with an offset.

use super::{
    Direction, Effect, EffectDescription, Facts, Memory, OwnSignals, Point, TORQUE, describe, sign,
};

describe!(
    TorqueSensorOffset,
    "torque_sensor_offset",
    "τ_m = … + os · (1 + b0T · sign(τ) · sign(q̇))",
    "sensor model",
    coefficients: ["os": TORQUE],
    shape: [],
    shows_as: "constant, whatever the sign of q̇",
    excited_by: "a reading of the sensor with the joint free of load",
    shown_by: WidePosition,
    taken_for: ["asymmetric_coulomb", "cable_spring"]
);

impl Effect for TorqueSensorOffset {
    fn description(&self) -> &EffectDescription {
        &self.0
    }

    // The offset is no load: friction does not grow with it, to first order.
    // This tells it from friction that differs by direction.
    fn evaluate(&self, _shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        columns.fill(1.0 + point.load_slope * sign(point.load) * point.sign());
    }

    fn needs_prediction(&self) -> bool {
        true
    }

    fn unavailable(&self, facts: &Facts) -> Option<String> {
        (!facts.joint_torque).then(|| "no joint torque sensor".to_owned())
    }

    fn own_signals(&self) -> OwnSignals {
        OwnSignals {
            names: &["velocity", "position"],
            direction: Direction::Same,
            any_pair: false,
        }
    }
}
