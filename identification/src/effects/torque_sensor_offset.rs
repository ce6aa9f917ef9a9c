//! A joint torque sensor with a constant offset.

use ferntast_model::friction::{ConstantOf, Contrast, Direction, OwnSignals, Proposal, TORQUE};

use super::{Effect, Facts, Memory, Point, free, row, sign};

row!(
    TorqueSensorOffset,
    id: "torque_sensor_offset",
    equation: "τ_m = … + os · (1 + b0T · sign(τ) · sign(q̇))",
    source: "sensor model",
    coefficients: &[free("os", TORQUE)],
    shows_as: "constant, whatever the sign of q̇",
    excited_by: "a reading of the sensor with the joint free of load",
    shown_by: Proposal::WidePosition,
    contrasts: &[Contrast::WidePosition],
    confusable_with: &["asymmetric_coulomb", "cable_spring"],
    constant: Some(ConstantOf::Sensor),
    needs_prediction: true,
    own_signals: OwnSignals::new(&["velocity", "position"], Direction::Same),
);

impl Effect for TorqueSensorOffset {
    row!(methods);

    // The offset is no load: friction does not grow with it, to first order.
    // This distinguishes it from friction that differs by direction.
    fn evaluate(&self, _shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        columns.fill(1.0 + point.load_slope * sign(point.load) * point.sign());
    }

    fn unavailable(&self, facts: &Facts) -> Option<String> {
        facts.no_torque_channel()
    }
}
