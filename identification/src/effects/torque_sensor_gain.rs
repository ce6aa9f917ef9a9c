//! A joint torque sensor with a gain error.

use ferntast_model::friction::{Contrast, Direction, Exact, ONE, OwnSignals, Proposal};

use super::{Effect, Facts, Memory, Point, free, row};

row!(
    TorqueSensorGain,
    id: "torque_sensor_gain",
    equation: "τ_m = … + gs · τ",
    source: "sensor model",
    coefficients: &[free("gs", ONE)],
    shows_as: "over τ, whatever the sign of q̇",
    excited_by: "loads in both directions at constant speed, at positions that differ for the same load",
    shown_by: Proposal::LoadSteps,
    contrasts: &[Contrast::FastByLoad, Contrast::FastBySpring, Contrast::FastByWeight, Contrast::WidePosition],
    confusable_with: &["cable_spring", "motor_constant"],
    exact: &[Exact::JointTorque],
    own_signals: OwnSignals::new(&["load"], Direction::Same),
);

impl Effect for TorqueSensorGain {
    row!(methods);

    fn evaluate(&self, _shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        if let [c] = columns {
            *c = point.load;
        }
    }

    fn unavailable(&self, facts: &Facts) -> Option<String> {
        facts.no_torque_channel()
    }

    fn plausible(&self, _shape: &[f64], coefficients: &[f64]) -> bool {
        coefficients.iter().all(|c| c.abs() < 0.8)
    }
}
