//! Friction that falls as the lubricant builds up.

use super::{
    Direction, Effect, EffectDescription, Facts, Memory, OwnSignals, Point, SPEED, TORQUE,
    describe, logarithmic,
};

describe!(
    Stribeck,
    "stribeck",
    "τ_F = bs · exp(−(q̇/vs)²) · sign(q̇)",
    "Armstrong-Hélouvry, Dupont, Canudas de Wit 1994",
    coefficients: ["bs": TORQUE],
    shape: ["vs": SPEED],
    shows_as: "bump near q̇ = 0",
    excited_by: "slow constant speeds in small steps, down to the slowest",
    shown_by: WideSpeedRange,
    taken_for: ["coulomb", "presliding_hysteresis"]
);

impl Effect for Stribeck {
    fn description(&self) -> &EffectDescription {
        &self.0
    }

    fn evaluate(&self, shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        if let ([c], [vs, ..]) = (columns, shape) {
            *c = (-(point.velocity / vs).powi(2)).exp() * point.sign();
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
        let low = f64::max(0.7 * facts.speed[0], 0.01 * facts.speed[1]);
        vec![[low, f64::max(0.4 * facts.speed[1], 2.0 * low)]]
    }

    // Friction that rises towards rest; a dip there is something else.
    fn plausible(&self, _shape: &[f64], coefficients: &[f64]) -> bool {
        coefficients.iter().all(|c| *c > 0.0)
    }

    fn own_signals(&self) -> OwnSignals {
        OwnSignals {
            names: &["velocity"],
            direction: Direction::Opposite,
            any_pair: false,
        }
    }
}
