//! Cubic viscous friction.

use super::{Direction, Effect, EffectDescription, Memory, OwnSignals, Point, Unit, describe};

describe!(
    CubicViscous,
    "cubic_viscous",
    "τ_F = b3 · q̇³",
    "ROKVISS, lessons learned, equation (4)",
    coefficients: ["b3": Unit::new("Nm s³/rad³", "N s³/m³")],
    shape: [],
    shows_as: "S over q̇",
    excited_by: "constant speeds over the widest range that the joint allows",
    shown_by: WideSpeedRange,
    taken_for: ["quadratic_viscous"]
);

impl Effect for CubicViscous {
    fn description(&self) -> &EffectDescription {
        &self.0
    }

    fn evaluate(&self, _shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        if let [c] = columns {
            *c = point.velocity.powi(3);
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
