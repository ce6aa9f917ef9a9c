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
        let ([c], [limit, ..]) = (columns, shape) else {
            return;
        };
        let beyond = |torque: f64| sign(torque) * (torque.abs() - limit).max(0.0);
        *c = match is_of_sensor(shape) {
            true => -beyond(point.motor_predicted),
            false => beyond(point.motor_torque),
        };
    }

    // Limits that more than one sample in four exceeds are none: there the torque that
    // is measured would explain itself.
    fn shapes(&self, facts: &Facts) -> Vec<Vec<f64>> {
        let [low, _] = limits(facts);
        (0..LIMITS)
            .flat_map(|i| {
                let share = f64::from(i) / f64::from(LIMITS - 1);
                let limit = low + share * (facts.motor_torque - low).max(0.0);
                [vec![limit, 0.0], vec![limit, 1.0]]
            })
            .collect()
    }

    fn bounds(&self, facts: &Facts) -> Vec<[f64; 2]> {
        // The place is not refined.
        vec![limits(facts), [0.0, 0.0]]
    }

    fn unjudged_samples(&self, shape: &[f64], points: &[Point]) -> Vec<usize> {
        let [limit, ..] = shape else {
            return Vec::new();
        };
        let torque = |point: &Point| match is_of_sensor(shape) {
            true => point.motor_predicted,
            false => point.motor_torque,
        };
        let beyond = |(_, point): &(usize, &Point)| torque(point).abs() > *limit;
        let samples = points.iter().enumerate().filter(beyond);
        samples.map(|(at, _)| at).collect()
    }

    // Beyond a drive's limit the torque that is measured explains itself; beyond a sensor's range
    // the model has to.
    fn most_unjudged(&self, shape: &[f64]) -> f64 {
        if is_of_sensor(shape) { 0.35 } else { 0.25 }
    }

    // Measured torque as a column explains its own noise with a small
    // coefficient; clipping takes off the whole excess. Of a sensor's range the excess is that of
    // a torque by the model, which clipped samples have bent: up to two thirds of it are missed at first.
    fn plausible(&self, shape: &[f64], coefficients: &[f64]) -> bool {
        let possible = if is_of_sensor(shape) {
            0.4..3.0
        } else {
            0.7..1.6
        };
        coefficients.iter().all(|c| possible.contains(c))
    }
}

/// Whether it is the range of the sensor, not the drive's.
fn is_of_sensor(shape: &[f64]) -> bool {
    shape.get(1).is_some_and(|place| *place > 0.5)
}

/// Limits tried of each place.
const LIMITS: u32 = 11;

/// Lowest and highest limit \[Nm\]. A demand that is logged may be many times what flows.
fn limits(facts: &Facts) -> [f64; 2] {
    let high = 1.05 * facts.motor_torque;
    [facts.common_torque.min(high), high]
}
