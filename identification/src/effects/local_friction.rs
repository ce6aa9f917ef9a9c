//! A spot where friction differs.

use super::{
    ANGLE, Direction, Effect, EffectDescription, Facts, Memory, OwnSignals, Point, TORQUE, describe,
};

describe!(
    LocalFriction,
    "local_friction",
    "τ_F = bl · exp(−((q − ql)/wl)²) · sign(q̇)",
    "a dent or a dry spot",
    coefficients: ["bl": TORQUE],
    shape: ["ql": ANGLE, "wl": ANGLE],
    shows_as: "bump at one q, sign by direction",
    excited_by: "slow motion in both directions past the spot",
    shown_by: WidePosition,
    taken_for: ["ripple"]
);

impl Effect for LocalFriction {
    fn description(&self) -> &EffectDescription {
        &self.0
    }

    fn evaluate(&self, shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        if let ([c], [spot, width, ..]) = (columns, shape) {
            *c = (-((point.position - spot) / width).powi(2)).exp() * point.sign();
        }
    }

    fn shapes(&self, facts: &Facts) -> Vec<Vec<f64>> {
        let range = facts.travel();
        [(0.03, 24), (0.06, 16), (0.12, 9)]
            .into_iter()
            .flat_map(|(width, count)| {
                (0..count).map(move |i| {
                    let share = (f64::from(i) + 0.5) / f64::from(count);
                    vec![facts.position[0] + share * range, width * range]
                })
            })
            .collect()
    }

    fn bounds(&self, facts: &Facts) -> Vec<[f64; 2]> {
        vec![
            facts.position,
            [0.01 * facts.travel(), 0.25 * facts.travel()],
        ]
    }

    fn own_signals(&self) -> OwnSignals {
        OwnSignals {
            names: &["position"],
            direction: Direction::Opposite,
            any_pair: false,
        }
    }
}
