//! A gap between the motor and the gear with its load.

use super::{
    ANGLE, Effect, EffectDescription, Facts, Memory, ONE, Point, describe, logarithmic, sign,
};

describe!(
    Backlash,
    "backlash",
    "in the gap τ_m = J q̈: τ and τ_F do not reach the motor",
    "dead zone (play) between bodies with dry friction",
    coefficients: ["c": ONE],
    shape: ["gap": ANGLE, "bend": ANGLE],
    shows_as: "jump after reversal of load",
    excited_by: "reversals of the load at low speed",
    shown_by: SlowReversals,
    taken_for: ["presliding_hysteresis"]
);

/// Places in the memory: friction that reaches the motor \[Nm\]; place in the
/// gap \[rad\] from its middle; whether the motor is in it; whether begun.
const FRICTION: usize = 0;
const PLACE: usize = 1;
const FREE: usize = 2;
const BEGUN: usize = 3;

impl Effect for Backlash {
    fn description(&self) -> &EffectDescription {
        &self.0
    }

    // The gear stands still until the torque through its teeth, τ + F, leaves
    // τ ± τ_F. As the motor turns back, F falls by 2 τ_F over twice the travel
    // `bend` (teeth are no stiffer than that), rests at −τ while the motor
    // crosses the gap, and falls on behind it. A load that friction cannot hold
    // (|τ| > τ_F) follows the motor, and there is no gap.
    fn evaluate(&self, shape: &[f64], point: &Point, memory: &mut Memory, columns: &mut [f64]) {
        let ([c], [gap, bend, ..]) = (columns, shape) else {
            return;
        };
        let half = 0.5 * gap;
        let most = point.friction_predicted.abs();
        let mut step = point.velocity * point.period;
        if memory[BEGUN] == 0.0 {
            let friction = point.friction_predicted;
            *memory = [friction, sign(friction + point.load) * half, 0.0, 1.0];
        }
        let stiffness = most / bend.max(1e-12);
        if memory[FREE] != 0.0 && point.load.abs() >= most {
            memory[FREE] = 0.0;
            memory[PLACE] = sign(point.load) * half;
        }
        if memory[FREE] == 0.0 {
            let side = sign(memory[PLACE]);
            let next = (memory[FRICTION] + stiffness * step).clamp(-most, most);
            if (next + point.load) * side >= 0.0 || point.load.abs() >= most {
                memory[FRICTION] = next;
            } else {
                // The tooth has come off: the rest of the step is in the gap.
                let used = (-point.load - memory[FRICTION]) / stiffness.max(1e-12);
                step = if used * step > 0.0 { step - used } else { step };
                memory[FREE] = 1.0;
            }
        }
        if memory[FREE] != 0.0 {
            let place = memory[PLACE] + step;
            memory[FRICTION] = (-point.load).clamp(-most, most);
            memory[PLACE] = place.clamp(-half, half);
            if place.abs() >= half {
                memory[FREE] = 0.0;
                let beyond = (place - memory[PLACE]) * stiffness;
                memory[FRICTION] = (memory[FRICTION] + beyond).clamp(-most, most);
            }
        }
        *c = memory[FRICTION] - point.friction_predicted;
    }

    fn shapes(&self, facts: &Facts) -> Vec<Vec<f64>> {
        let [gaps, bends] = [0, 1].map(|at| self.bounds(facts)[at]);
        logarithmic(gaps[0], gaps[1], 9)
            .into_iter()
            .flat_map(|gap| {
                logarithmic(bends[0], bends[1], 3)
                    .into_iter()
                    .map(move |bend| vec![gap, bend])
            })
            .collect()
    }

    fn bounds(&self, facts: &Facts) -> Vec<[f64; 2]> {
        let travel = facts.travel();
        vec![
            [0.004 * travel, 0.15 * travel],
            [0.0005 * travel, 0.006 * travel],
        ]
    }

    fn needs_prediction(&self) -> bool {
        true
    }

    // All of the torque is missing in the gap, not a part of it.
    fn plausible(&self, _shape: &[f64], coefficients: &[f64]) -> bool {
        coefficients.iter().all(|c| (0.3..1.7).contains(c))
    }
}
