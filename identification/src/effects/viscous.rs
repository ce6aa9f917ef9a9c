//! Linear viscous friction.

use super::{
    Direction, Effect, EffectDescription, Exact, Memory, OwnSignals, Point, Unit, describe,
};

describe!(
    Viscous,
    "viscous",
    "τ_F = b1 · q̇",
    "ROKVISS, lessons learned, equation (3)",
    coefficients: ["b1": Unit::new("Nm s/rad", "N s/m")],
    shape: [],
    shows_as: "slope over q̇",
    excited_by: "constant speeds over the whole range",
    shown_by: WideSpeedRange,
    taken_for: ["channel_delay"]
);

impl Effect for Viscous {
    fn description(&self) -> &EffectDescription {
        &self.0
    }

    fn evaluate(&self, _shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        if let [c] = columns {
            *c = point.velocity;
        }
    }

    fn exact(&self) -> &'static [Exact] {
        &[Exact::Velocity]
    }

    fn own_signals(&self) -> OwnSignals {
        OwnSignals {
            names: &["velocity"],
            direction: Direction::Opposite,
            any_pair: false,
        }
    }
}
