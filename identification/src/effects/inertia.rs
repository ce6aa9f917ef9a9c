//! An inertia other than the one given.

use super::{
    Direction, Effect, EffectDescription, Exact, Facts, Memory, OwnSignals, Point, Unit, describe,
};

describe!(
    InertiaError,
    "inertia",
    "τ_m = … + ΔJ · q̈",
    "rigid body",
    coefficients: ["dJ": Unit::new("kg m²", "kg")],
    shape: [],
    shows_as: "slope over q̈",
    excited_by: "fast accelerations at low speed",
    shown_by: FastUnloaded,
    taken_for: ["channel_delay"]
);

impl Effect for InertiaError {
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

    fn unavailable(&self, facts: &Facts) -> Option<String> {
        (facts.inertia.is_none()).then(|| "the inertia is fitted already".to_owned())
    }

    fn own_signals(&self) -> OwnSignals {
        OwnSignals {
            names: &["acceleration"],
            direction: Direction::Same,
            any_pair: false,
        }
    }
}
