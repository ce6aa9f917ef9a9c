//! Compliance behind the tip: after a reversal the tip rests until the spring is
//! deflected as far as friction can hold.

use ferntast_model::friction::{Contrast, ONE, Proposal, STIFFNESS, Subject};

use super::{Effect, Facts, Memory, Point, free, logarithmic, row};

row!(
    ContactCompliance,
    id: "contact_compliance",
    of: Subject::Contact,
    equation: "dF_T/dr = k while |F_T| is below what friction holds, else the tip slides",
    source: "ROKVISS, lessons learned, Fig. 16; Prandtl 1928 (spring and dry friction in series)",
    coefficients: &[free("wound_up", ONE)],
    shape: &[free("k", STIFFNESS)],
    shows_as: "wrong sign of F_T near rest, after each reversal over the same travel",
    excited_by: "reversals at several normal forces, slow and fast",
    shown_by: Proposal::ContactTurns,
    contrasts: &[Contrast::ContactTurns],
    confusable_with: &["contact_stribeck"],
    shows_at_reversals: true,
    needs_prediction: true,
);

/// Indices of the memory: force in the spring \[N\]; place of the last sample
/// \[m\]; whether begun.
const FORCE: usize = 0;
const PLACE: usize = 1;
const BEGUN: usize = 2;

impl Effect for ContactCompliance {
    row!(methods);

    // The measured place is that of the motors. The force of the spring is limited
    // to the friction that the model predicts for sliding; the column is the
    // difference of both.
    fn evaluate(&self, shape: &[f64], point: &Point, memory: &mut Memory, columns: &mut [f64]) {
        let ([c], [stiffness, ..]) = (columns, shape) else {
            return;
        };
        let most = point.friction_predicted.abs();
        if memory[BEGUN] == 0.0 {
            *memory = [point.friction_predicted, point.position, 1.0, 0.0];
        }
        let stretch = stiffness * (point.position - memory[PLACE]);
        memory[FORCE] = (memory[FORCE] + stretch).clamp(-most, most);
        memory[PLACE] = point.position;
        *c = memory[FORCE] - point.friction_predicted;
    }

    fn unavailable(&self, facts: &Facts) -> Option<String> {
        (!facts.load_coulomb).then(|| {
            "what winds up is the friction of contact_coulomb, which the model does not have"
                .to_owned()
        })
    }

    fn shapes(&self, facts: &Facts) -> Vec<Vec<f64>> {
        let [low, high] = self.bounds(facts)[0];
        logarithmic(low, high, 13)
            .into_iter()
            .map(|stiffness| vec![stiffness])
            .collect()
    }

    // From deflection over a fifth of the travel to what the position cannot resolve.
    fn bounds(&self, facts: &Facts) -> Vec<[f64; 2]> {
        let soft = 5.0 * facts.motor_torque / facts.travel().max(1e-9);
        let stiff = facts.motor_torque / facts.resolved.max(1e-9);
        vec![[soft, stiff.max(2.0 * soft)]]
    }

    // All of the friction goes through the spring, not a part of it.
    fn plausible(&self, _shape: &[f64], coefficients: &[f64]) -> bool {
        coefficients.iter().all(|c| (0.75..1.33).contains(c))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Columns plus prediction: the force in the spring, sample by sample.
    fn forces(places: &[f64], friction: f64, stiffness: f64) -> Vec<f64> {
        let effect = ContactCompliance::default();
        let mut memory = Memory::default();
        let mut last = places[0];
        places
            .iter()
            .map(|&position| {
                let direction = if position < last { -1.0 } else { 1.0 };
                last = position;
                let point = Point {
                    position,
                    friction_predicted: direction * friction,
                    ..Point::default()
                };
                let mut column = [0.0];
                effect.evaluate(&[stiffness], &point, &mut memory, &mut column);
                column[0] + point.friction_predicted
            })
            .collect()
    }

    #[test]
    fn after_a_turn_the_force_has_the_old_sign_until_half_of_the_way_is_wound_up() {
        // 6 N at 1e4 N/m: ±0.6 mm.
        let back: Vec<f64> = (0..=20).map(|step| -1e-4 * f64::from(step)).collect();
        let force = forces(&[&[-1e-3, 0.0], &back[..]].concat(), 6.0, 1e4);
        assert_eq!(force[1], 6.0);
        assert!((force[2 + 3] - 3.0).abs() < 1e-9, "{}", force[5]);
        assert!(force[2 + 5] > 0.0 && force[2 + 7] < 0.0);
        assert!((force[2 + 12] + 6.0).abs() < 1e-9 && force[2 + 20] == -6.0);
    }

    proptest! {
        #[test]
        fn the_spring_never_holds_more_than_friction_and_never_gains_energy(
            steps in prop::collection::vec(-3e-4..3e-4_f64, 2..200),
            friction in 0.1..20.0_f64,
            stiffness in 1e3..1e6_f64,
        ) {
            let mut place = 0.0;
            let places: Vec<f64> = steps.iter().map(|step| { place += step; place }).collect();
            let force = forces(&places, friction, stiffness);
            let mut work = 0.5 * force[0] * force[0] / stiffness;
            for (pair, moved) in force.windows(2).zip(&steps[1..]) {
                prop_assert!(pair[1].abs() <= friction);
                work += pair[1] * moved;
            }
            let stored = 0.5 * force[force.len() - 1].powi(2) / stiffness;
            prop_assert!(work - stored > -1e-9);
        }
    }
}
