//! A stretch of the contour where friction differs.

use super::{
    ANGLE, Direction, Effect, EffectDescription, Facts, Memory, ONE, OwnSignals, Point, describe,
};

describe!(
    ContactSpot,
    "contact_spot",
    of: Contact,
    "F_T = bl · exp(−(|r − rl|/wl)^n) · |F_N| · sign(ṙ)",
    "a scratch, a stain of lubricant",
    coefficients: ["bl": ONE],
    shape: ["rl": ANGLE, "wl": ANGLE, "n": ONE],
    shows_as: "bump over place, sign by direction",
    excited_by: "sliding in both directions over the whole contour",
    shown_by: ContactSweep,
    taken_for: ["contact_coulomb"]
);

impl Effect for ContactSpot {
    fn description(&self) -> &EffectDescription {
        &self.0
    }

    fn evaluate(&self, shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        if let ([c], [place, width, evenness, ..]) = (columns, shape) {
            let off = (point.position - place).abs() / width;
            *c = (-off.powf(*evenness)).exp() * point.load.abs() * point.sign();
        }
    }

    fn shapes(&self, facts: &Facts) -> Vec<Vec<f64>> {
        let range = facts.travel();
        [(0.03, 24), (0.06, 16), (0.12, 9), (0.2, 6)]
            .into_iter()
            .flat_map(|(width, count)| {
                (0..count).map(move |i| {
                    let share = (f64::from(i) + 0.5) / f64::from(count);
                    vec![facts.position[0] + share * range, width * range, 2.5]
                })
            })
            .collect()
    }

    fn bounds(&self, facts: &Facts) -> Vec<[f64; 2]> {
        vec![
            facts.position,
            [0.01 * facts.travel(), 0.3 * facts.travel()],
            // From a bump to a stretch with sharp ends.
            [1.5, 8.0],
        ]
    }

    fn own_signals(&self) -> OwnSignals {
        OwnSignals {
            names: &["place"],
            direction: Direction::Opposite,
            any_pair: false,
        }
    }
}
