//! A joint torque sensor whose gain is off.

use super::{
    Direction, Effect, EffectDescription, Exact, Facts, Memory, ONE, OwnSignals, Point, describe,
};

describe!(
    TorqueSensorGain,
    "torque_sensor_gain",
    "τ_m = … + gs · τ",
    "sensor model",
    coefficients: ["gs": ONE],
    shape: [],
    shows_as: "over τ, whatever the sign of q̇",
    excited_by: "loads in both directions at constant speed, at positions that differ for the same load",
    shown_by: LoadSteps,
    taken_for: ["cable_spring", "motor_constant"]
);

impl Effect for TorqueSensorGain {
    fn description(&self) -> &EffectDescription {
        &self.0
    }

    fn evaluate(&self, _shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        if let [c] = columns {
            *c = point.load;
        }
    }

    fn exact(&self) -> &'static [Exact] {
        &[Exact::JointTorque]
    }

    fn unavailable(&self, facts: &Facts) -> Option<String> {
        (!facts.joint_torque).then(|| "no joint torque sensor".to_owned())
    }

    fn plausible(&self, _shape: &[f64], coefficients: &[f64]) -> bool {
        coefficients.iter().all(|c| c.abs() < 0.8)
    }

    fn own_signals(&self) -> OwnSignals {
        OwnSignals {
            names: &["load"],
            direction: Direction::Same,
            any_pair: false,
        }
    }
}
