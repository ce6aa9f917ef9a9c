//! Quadratic and cubic viscous friction together.

use super::{Direction, Effect, EffectDescription, Memory, OwnSignals, Point, Unit, describe};

describe!(
    NonlinearViscous,
    "nonlinear_viscous",
    "τ_F = b2 · q̇|q̇| + b3 · q̇³",
    "ROKVISS, lessons learned, the step from equation (3) to (4)",
    coefficients: ["b2": Unit::new("Nm s²/rad²", "N s²/m²"), "b3": Unit::new("Nm s³/rad³", "N s³/m³")],
    shape: [],
    shows_as: "S over q̇",
    excited_by: "constant speeds over the widest range that the joint allows",
    shown_by: WideSpeedRange,
    taken_for: ["stribeck"]
);

impl Effect for NonlinearViscous {
    fn description(&self) -> &EffectDescription {
        &self.0
    }

    fn evaluate(&self, _shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        if let [quadratic, cubic] = columns {
            *quadratic = point.velocity * point.velocity.abs();
            *cubic = point.velocity.powi(3);
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
