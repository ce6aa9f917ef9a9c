//! A joint torque sensor with gain and zero wrong at once, or a model in its place.

use ferntast_model::friction::{Contrast, Direction, Exact, ONE, OwnSignals, Proposal, TORQUE};

use super::{Effect, Facts, Memory, Point, free, row, sign};

row!(
    TorqueSensorCalibration,
    id: "torque_sensor_calibration",
    equation: "τ_m = … + gs · τ + os · (1 + b0T · sign(τ) · sign(q̇))",
    source: "sensor model; a load by a model whose parameters are uncertain",
    coefficients: &[free("gs", ONE), free("os", TORQUE)],
    shows_as: "straight line over τ that misses the origin, whatever the sign of q̇",
    excited_by: "loads in both directions at constant speed, at positions that differ for the same load, and none",
    shown_by: Proposal::LoadSteps,
    contrasts: &[Contrast::FastByLoad, Contrast::FastBySpring, Contrast::FastByWeight, Contrast::WidePosition],
    confusable_with: &["cable_spring", "gravity", "motor_constant"],
    contains: &[("torque_sensor_gain", 1), ("torque_sensor_offset", 0), ("asymmetric_coulomb", 0)],
    // The zero goes with the friction that the load makes: no channel.
    exact: &[Exact::JointTorque],
    needs_prediction: true,
    own_signals: OwnSignals::new(&["load", "velocity", "position"], Direction::Same),
);

impl Effect for TorqueSensorCalibration {
    row!(methods);

    // As in `torque_sensor_gain` and `torque_sensor_offset`.
    fn evaluate(&self, _shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        if let [gain, zero] = columns {
            *gain = point.load;
            *zero = 1.0 + point.load_slope * sign(point.load) * point.sign();
        }
    }

    fn unavailable(&self, facts: &Facts) -> Option<String> {
        facts.no_torque_channel()
    }

    fn plausible(&self, _shape: &[f64], coefficients: &[f64]) -> bool {
        coefficients.first().is_none_or(|gain| gain.abs() < 0.8)
    }
}
