//! A motor constant other than the one given: recorded motor torque too large by a share.

use ferntast_model::friction::{Contrast, Direction, Exact, ONE, OwnSignals, Proposal};

use super::{Effect, Facts, Memory, Point, free, row};

row!(
    MotorConstant,
    id: "motor_constant",
    equation: "τ_m = (1 + gm) · (J q̈ + τ + τ_F)",
    source: "ROKVISS, lessons learned, equation (1)",
    coefficients: &[free("gm", ONE)],
    shows_as: "proportional to τ_m",
    excited_by: "fast accelerations without load, beside loads at constant speed",
    shown_by: Proposal::FastUnloaded,
    contrasts: &[Contrast::FastByLoad, Contrast::FastBySpring, Contrast::FastByWeight],
    confusable_with: &["load_coulomb", "torque_sensor_gain", "inertia"],
    exact: &[Exact::Driven],
    own_signals: OwnSignals::new(&["load"], Direction::Same),
);

impl Effect for MotorConstant {
    row!(methods);

    // The share that falls on τ_F is absorbed by the friction's own parameters.
    fn evaluate(&self, _shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        if let [c] = columns {
            *c = point.load;
        }
    }

    fn unavailable(&self, facts: &Facts) -> Option<String> {
        (facts.inertia.is_none() || !facts.joint_torque).then(|| "it needs a known inertia and a joint torque sensor to be told from the parameters themselves".to_owned())
    }

    fn plausible(&self, _shape: &[f64], coefficients: &[f64]) -> bool {
        coefficients.iter().all(|c| c.abs() < 0.5)
    }
}
