//! A joint torque sensor with an offset.

use super::{
    Direction, Effect, EffectDescription, Exact, Facts, Memory, OwnSignals, Point, TORQUE, describe,
};

describe!(
    TorqueSensorOffset,
    "torque_sensor_offset",
    "τ_m = … + os",
    "sensor model",
    coefficients: ["os": TORQUE],
    shape: [],
    shows_as: "constant, whatever the sign of q̇",
    excited_by: "a reading of the sensor with the joint free of load",
    taken_for: ["asymmetric_coulomb", "cable_spring"]
);

impl Effect for TorqueSensorOffset {
    fn description(&self) -> &EffectDescription {
        &self.0
    }

    fn evaluate(&self, _shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        let _ = point;
        columns.fill(1.0);
    }

    fn exact(&self) -> &'static [Exact] {
        &[Exact::One]
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
