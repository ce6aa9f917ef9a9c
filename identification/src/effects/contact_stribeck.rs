//! Contact friction that falls from rest to sliding.

use super::{
    Direction, Effect, EffectDescription, Facts, Memory, ONE, OwnSignals, Point, SPEED, describe,
    logarithmic,
};

describe!(
    ContactStribeck,
    "contact_stribeck",
    of: Contact,
    "F_T = bsT · exp(−(ṙ/vs)²) · |F_N| · sign(ṙ)",
    "Armstrong-Hélouvry, Dupont, Canudas de Wit 1994",
    coefficients: ["bsT": ONE],
    shape: ["vs": SPEED],
    shows_as: "bump near rest",
    excited_by: "slow constant speeds in small steps, down to the slowest",
    shown_by: ContactSpeeds,
    taken_for: ["contact_compliance"]
);

impl Effect for ContactStribeck {
    fn description(&self) -> &EffectDescription {
        &self.0
    }

    fn evaluate(&self, shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        if let ([c], [vs, ..]) = (columns, shape) {
            *c = (-(point.velocity / vs).powi(2)).exp() * point.load.abs() * point.sign();
        }
    }

    fn shapes(&self, facts: &Facts) -> Vec<Vec<f64>> {
        let [low, high] = self.bounds(facts)[0];
        logarithmic(low, high, 9)
            .into_iter()
            .map(|vs| vec![vs])
            .collect()
    }

    fn bounds(&self, facts: &Facts) -> Vec<[f64; 2]> {
        vec![[0.02 * facts.speed[1], 0.5 * facts.speed[1]]]
    }

    // Friction that rises towards rest; a dip there is something else.
    fn plausible(&self, _shape: &[f64], coefficients: &[f64]) -> bool {
        coefficients.iter().all(|c| *c > 0.0)
    }

    fn own_signals(&self) -> OwnSignals {
        OwnSignals {
            names: &["tip_velocity"],
            direction: Direction::Opposite,
            any_pair: false,
        }
    }
}
