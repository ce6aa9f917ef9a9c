//! Quadratic viscous friction.

use super::{Direction, Effect, EffectDescription, Memory, OwnSignals, Point, Unit, describe};

describe!(
    QuadraticViscous,
    "quadratic_viscous",
    "τ_F = b2 · q̇|q̇|",
    "ROKVISS, lessons learned, equation (4)",
    coefficients: ["b2": Unit::new("Nm s²/rad²", "N s²/m²")],
    shape: [],
    shows_as: "curvature over q̇",
    excited_by: "constant speeds over the widest range that the joint allows",
    shown_by: WideSpeedRange,
    taken_for: ["cubic_viscous"]
);

impl Effect for QuadraticViscous {
    fn description(&self) -> &EffectDescription {
        &self.0
    }

    fn evaluate(&self, _shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        if let [c] = columns {
            *c = point.velocity * point.velocity.abs();
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
