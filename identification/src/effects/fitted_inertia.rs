//! The inertia itself, where it is a parameter.

use super::{Effect, EffectDescription, Exact, Memory, Point, Unit, describe};

describe!(
    FittedInertia,
    "inertia_fit",
    "τ_m = J · q̈ + …",
    "rigid body",
    coefficients: ["inertia": Unit::new("kg m²", "kg")],
    shape: [],
    shows_as: "slope over q̈",
    excited_by: "fast accelerations at low speed",
    shown_by: FastUnloaded,
    taken_for: ["channel_delay"]
);

impl Effect for FittedInertia {
    fn description(&self) -> &EffectDescription {
        &self.0
    }

    fn evaluate(&self, _shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        if let [c] = columns {
            *c = point.acceleration;
        }
    }

    fn exact(&self) -> &'static [Exact] {
        &[Exact::Acceleration]
    }
}
