//! Coulomb friction.

use super::{Direction, Effect, EffectDescription, Memory, OwnSignals, Point, TORQUE, describe};

describe!(
    Coulomb,
    "coulomb",
    "τ_F = b0 · sign(q̇)",
    "ROKVISS, lessons learned, equation (3)",
    coefficients: ["b0": TORQUE],
    shape: [],
    shows_as: "step at q̇ = 0",
    excited_by: "motion in both directions",
    shown_by: WideSpeedRange,
    taken_for: ["presliding_hysteresis", "stribeck"]
);

impl Effect for Coulomb {
    fn description(&self) -> &EffectDescription {
        &self.0
    }

    fn evaluate(&self, _shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        if let [c] = columns {
            *c = point.sign();
        }
    }

    fn own_signals(&self) -> OwnSignals {
        OwnSignals {
            names: &["velocity"],
            direction: Direction::Opposite,
            any_pair: false,
        }
    }
}
