//! A gap between the motor and the gear with its load.

use super::{
    ANGLE, Effect, EffectDescription, Facts, Memory, ONE, Point, describe, logarithmic, sign,
};

describe!(
    Backlash,
    "backlash",
    "in the gap τ_m = J q̈: τ and τ_F do not reach the motor",
    "dead zone (play)",
    coefficients: ["c": ONE],
    shape: ["gap": ANGLE],
    shows_as: "jump after reversal of load",
    excited_by: "reversals of the load at low speed",
    taken_for: ["presliding_hysteresis"]
);

impl Effect for Backlash {
    fn description(&self) -> &EffectDescription {
        &self.0
    }

    // memory: [place in the gap, which half of it was seen last]. The motor lies
    // against the tooth that the torque to be transmitted asks for, and travels
    // from tooth to tooth when that torque changes its sign.
    fn evaluate(&self, shape: &[f64], point: &Point, memory: &mut Memory, columns: &mut [f64]) {
        let ([c], [gap, ..]) = (columns, shape) else {
            return;
        };
        let half = 0.5 * gap;
        let transmitted = point.friction_predicted + point.load;
        let side = sign(transmitted);
        if memory[1] == 0.0 {
            *memory = [side * half, 1.0, 0.0, 0.0];
        }
        let step = point.velocity * point.period;
        let free = side != 0.0 && (memory[0] - side * half).abs() > 1e-3 * half;
        if free {
            memory[0] = (memory[0] + step).clamp(-half, half);
        }
        *c = if free { -transmitted } else { 0.0 };
    }

    fn shapes(&self, facts: &Facts) -> Vec<Vec<f64>> {
        let [low, high] = self.bounds(facts)[0];
        logarithmic(low, high, 9)
            .into_iter()
            .map(|gap| vec![gap])
            .collect()
    }

    fn bounds(&self, facts: &Facts) -> Vec<[f64; 2]> {
        vec![[0.004 * facts.travel(), 0.15 * facts.travel()]]
    }

    fn needs_prediction(&self) -> bool {
        true
    }

    // All of the torque is missing in the gap, not a part of it.
    fn plausible(&self, _shape: &[f64], coefficients: &[f64]) -> bool {
        coefficients.iter().all(|c| (0.3..1.7).contains(c))
    }
}
