//! Viscous friction of a tip on a lubricated contour.

use super::{
    Direction, Effect, EffectDescription, Exact, Memory, OwnSignals, Point, Unit, describe,
};

describe!(
    ContactViscous,
    "contact_viscous",
    of: Contact,
    "F_T = c · ṙ",
    "Newtonian film between tip and contour",
    coefficients: ["c": Unit::same("N s/m")],
    shape: [],
    shows_as: "slope over tip velocity",
    excited_by: "sliding at many speeds; at one speed it is Coulomb friction",
    shown_by: ContactSpeeds,
    taken_for: ["contact_coulomb"]
);

impl Effect for ContactViscous {
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
            names: &["tip_velocity"],
            direction: Direction::Opposite,
            any_pair: false,
        }
    }
}
