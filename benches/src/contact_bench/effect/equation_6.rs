//! Coulomb friction by the normal force (equation 6) or the film's viscous
//! friction: there in every truth, hidden where the experimenter does not
//! believe in it, and then as large as the strength says.

use super::{Effect, HiddenEffect};
use crate::contact_bench::parameters::EdgeParameters;

struct Term {
    effect: HiddenEffect,
    /// In the unit of its term.
    value: f64,
}

pub(super) fn draw(effect: HiddenEffect, strength: f64, edge: &EdgeParameters) -> Box<dyn Effect> {
    let nominal = match effect {
        HiddenEffect::ContactViscous => edge.film,
        _ => edge.b0t,
    };
    Box::new(Term {
        effect,
        value: strength * nominal,
    })
}

impl Effect for Term {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![match self.effect {
            HiddenEffect::ContactViscous => ("c", self.value, "N·s/m"),
            _ => ("b0T", self.value, "-"),
        }]
    }

    fn prepare(&self, edge: &mut EdgeParameters) {
        match self.effect {
            HiddenEffect::ContactViscous => edge.film = self.value,
            _ => edge.b0t = self.value,
        }
    }
}
