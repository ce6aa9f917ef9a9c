//! Motor torque clipped: by the drive, while the log has what was asked for, or by the range of the current sensor.

use ferntast_model::friction::{ONE, Proposal, TORQUE};

use super::{Effect, Facts, Memory, Point, free, row, sign};

row!(
    CurrentSaturation,
    id: "current_saturation",
    equation: "0, drive: τ_m,log − τ_m = c · sign(τ_m,log)(|τ_m,log| − L)₊; 1, sensor: −c · sign(τ_m)(|τ_m| − L)₊; c = 1",
    source: "amplifier, magnetic saturation, sensor range",
    coefficients: &[free("c", ONE)],
    shape: &[free("L", TORQUE), free("place", ONE)],
    shows_as: "only at the limit",
    excited_by: "torque up to the limit and well below it",
    shown_by: Proposal::FastUnloaded,
    needs_prediction: true,
);

impl Effect for CurrentSaturation {
    row!(methods);

    fn evaluate(&self, shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        let ([c], [limit, place, ..]) = (columns, shape) else {
            return;
        };
        let beyond = |torque: f64| sign(torque) * (torque.abs() - limit).max(0.0);
        *c = if *place < 0.5 {
            beyond(point.motor_torque)
        } else {
            -beyond(point.motor_predicted)
        };
    }

    fn shapes(&self, facts: &Facts) -> Vec<Vec<f64>> {
        (0..11)
            .flat_map(|i| {
                let share = 0.5 + 0.05 * f64::from(i);
                [
                    vec![share * facts.motor_torque, 0.0],
                    vec![share * facts.motor_torque, 1.0],
                ]
            })
            .collect()
    }

    fn bounds(&self, facts: &Facts) -> Vec<[f64; 2]> {
        // The place is not refined.
        vec![
            [0.4 * facts.motor_torque, 1.05 * facts.motor_torque],
            [0.0, 0.0],
        ]
    }

    // Measured torque as a column explains its own noise with a small
    // coefficient; clipping takes off the whole excess.
    fn plausible(&self, shape: &[f64], coefficients: &[f64]) -> bool {
        let least = if shape.get(1).is_some_and(|place| *place > 0.5) {
            0.4
        } else {
            0.7
        };
        coefficients.iter().all(|c| (least..1.6).contains(c))
    }
}
