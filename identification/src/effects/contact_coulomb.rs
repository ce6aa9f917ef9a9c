//! Coulomb friction of a tip on a contour.

use super::{Direction, Effect, EffectDescription, Memory, ONE, OwnSignals, Point, describe};

describe!(
    ContactCoulomb,
    "contact_coulomb",
    of: Contact,
    "F_T = b0T · |F_N| · sign(ṙ)",
    "ROKVISS, lessons learned, equation (6)",
    coefficients: ["b0T": ONE],
    shape: [],
    shows_as: "step at ṙ = 0 that grows with the normal force",
    excited_by: "sliding in both directions at several normal forces",
    shown_by: ContactForces,
    taken_for: ["contact_viscous"]
);

impl Effect for ContactCoulomb {
    fn description(&self) -> &EffectDescription {
        &self.0
    }

    fn evaluate(&self, _shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        if let [c] = columns {
            *c = point.load.abs() * point.sign();
        }
    }

    fn own_signals(&self) -> OwnSignals {
        OwnSignals {
            names: &["normal_force"],
            direction: Direction::Opposite,
            any_pair: false,
        }
    }
}
