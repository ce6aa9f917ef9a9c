//! Friction that builds up over travel after a reversal.

use ferntast_model::friction::{ANGLE, AtReversal, Contrast, ONE, Proposal, TORQUE};

use super::{Effect, Facts, Memory, Point, free, logarithmic, row};

row!(
    PreslidingHysteresis,
    id: "presliding_hysteresis",
    equation: "τ_F = (bz + bzT |τ|) · (z − sign(q̇)), dz/dq = (sign(q̇) − z)/δ",
    source: "Dahl 1968; Canudas de Wit et al. 1995 (LuGre)",
    coefficients: &[free("bz", TORQUE), free("bzT", ONE)],
    shape: &[free("delta", ANGLE)],
    shows_as: "loop after each reversal, over travel not time",
    excited_by: "reversals at several amplitudes, slow and fast",
    shown_by: Proposal::SlowReversals,
    contrasts: &[Contrast::SlowReversals],
    confusable_with: &["elasticity", "backlash"],
    at_reversal: Some(AtReversal::Bristles),
);

impl Effect for PreslidingHysteresis {
    row!(methods);

    // memory: [bristle state z, started]. z follows the travel of each sample
    // exactly: z ← s + (z − s) exp(−|Δq|/δ).
    fn evaluate(&self, shape: &[f64], point: &Point, memory: &mut Memory, columns: &mut [f64]) {
        let s = point.sign();
        if let ([level, by_load], [delta, ..]) = (columns, shape) {
            memory[0] = s + (memory[0] - s) * (-point.travel().abs() / delta).exp();
            *level = memory[0] - s;
            *by_load = *level * point.load.abs();
        }
    }

    fn shapes(&self, facts: &Facts) -> Vec<Vec<f64>> {
        let [low, high] = self.bounds(facts)[0];
        logarithmic(low, high, 9)
            .into_iter()
            .map(|delta| vec![delta])
            .collect()
    }

    fn bounds(&self, facts: &Facts) -> Vec<[f64; 2]> {
        vec![[0.0015 * facts.travel(), 0.2 * facts.travel()]]
    }

    fn plausible(&self, _shape: &[f64], coefficients: &[f64]) -> bool {
        coefficients.first().is_some_and(|c| *c > 0.0)
    }
}
