//! Coulomb friction that grows with the load.

use super::{
    Direction, Effect, EffectDescription, Facts, Memory, ONE, OwnSignals, Point, describe,
};

describe!(
    LoadCoulomb,
    "load_coulomb",
    "τ_F = b0T · |τ| · sign(q̇)",
    "ROKVISS, lessons learned, equation (3)",
    coefficients: ["b0T": ONE],
    shape: [],
    shows_as: "step that grows with load",
    excited_by: "slow motion in both directions under loads from none to full",
    shown_by: LoadSteps,
    taken_for: ["torque_sensor_gain", "motor_constant"]
);

impl Effect for LoadCoulomb {
    fn description(&self) -> &EffectDescription {
        &self.0
    }

    fn evaluate(&self, _shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        if let [c] = columns {
            *c = point.load.abs() * point.sign();
        }
    }

    fn unavailable(&self, facts: &Facts) -> Option<String> {
        (!facts.loaded).then(|| {
            "no load: neither a joint torque sensor nor gravity, spring or inertia in the model"
                .to_owned()
        })
    }

    fn own_signals(&self) -> OwnSignals {
        OwnSignals {
            names: &["load"],
            direction: Direction::Opposite,
            any_pair: false,
        }
    }
}
