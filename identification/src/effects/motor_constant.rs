//! A motor constant other than the one given: recorded motor torque too large by a share.

use super::{
    Direction, Effect, EffectDescription, Exact, Facts, Memory, ONE, OwnSignals, Point, describe,
};

describe!(
    MotorConstant,
    "motor_constant",
    "τ_m = (1 + gm) · (J q̈ + τ + τ_F)",
    "ROKVISS, lessons learned, equation (1)",
    coefficients: ["gm": ONE],
    shape: [],
    shows_as: "proportional to τ_m",
    excited_by: "fast accelerations without load, beside loads at constant speed",
    shown_by: FastUnloaded,
    taken_for: ["load_coulomb", "torque_sensor_gain", "inertia"]
);

impl Effect for MotorConstant {
    fn description(&self) -> &EffectDescription {
        &self.0
    }

    // The share that falls on τ_F is absorbed by the friction's own parameters.
    fn evaluate(&self, _shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        if let [c] = columns {
            *c = point.load;
        }
    }

    fn exact(&self) -> &'static [Exact] {
        &[Exact::Driven]
    }

    fn unavailable(&self, facts: &Facts) -> Option<String> {
        (facts.inertia.is_none() || !facts.joint_torque).then(|| "it needs a known inertia and a joint torque sensor to be told from the parameters themselves".to_owned())
    }

    fn plausible(&self, _shape: &[f64], coefficients: &[f64]) -> bool {
        coefficients.iter().all(|c| c.abs() < 0.5)
    }

    fn own_signals(&self) -> OwnSignals {
        OwnSignals {
            names: &["load"],
            direction: Direction::Same,
            any_pair: false,
        }
    }
}
