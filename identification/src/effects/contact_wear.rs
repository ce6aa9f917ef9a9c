//! Contact friction that changes with the date.

use super::{
    DAY, Direction, Effect, EffectDescription, Facts, Memory, ONE, OwnSignals, Point, describe,
    logarithmic,
};

describe!(
    ContactWear,
    "contact_wear",
    of: Contact,
    "F_T = bw · (1 − exp(−t/tw)) · |F_N| · sign(ṙ), t in days",
    "ROKVISS, lessons learned, Fig. 17: the lubricated surface slowly nears the bare one",
    coefficients: ["bw": ONE],
    shape: ["tw": DAY],
    shows_as: "step at ṙ = 0 changes with date",
    excited_by: "the same sliding on many dates",
    shown_by: ContactDates,
    taken_for: ["contact_coulomb"]
);

impl Effect for ContactWear {
    fn description(&self) -> &EffectDescription {
        &self.0
    }

    fn evaluate(&self, shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        if let ([c], [days, ..]) = (columns, shape) {
            *c = (1.0 - (-point.days / days).exp()) * point.load.abs() * point.sign();
        }
    }

    fn unavailable(&self, facts: &Facts) -> Option<String> {
        (facts.sessions < 4 || facts.days < 0.5)
            .then(|| "fewer than four sessions or all on one day".to_owned())
    }

    fn shapes(&self, facts: &Facts) -> Vec<Vec<f64>> {
        let [low, high] = self.bounds(facts)[0];
        logarithmic(low, high, 7)
            .into_iter()
            .map(|days| vec![days])
            .collect()
    }

    // From all of it between the first two sessions to a straight line.
    fn bounds(&self, facts: &Facts) -> Vec<[f64; 2]> {
        vec![[0.02 * facts.days, 5.0 * facts.days]]
    }

    fn between_sessions(&self) -> bool {
        true
    }

    fn varies(&self) -> Option<&'static str> {
        Some("contact_coulomb")
    }

    fn own_signals(&self) -> OwnSignals {
        OwnSignals {
            names: &["date"],
            direction: Direction::Either,
            any_pair: true,
        }
    }
}
