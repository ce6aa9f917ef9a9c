//! A joint that winds up between motor and measured position.

use super::{Effect, EffectDescription, Facts, Memory, Point, Unit, describe};

describe!(
    Elasticity,
    "elasticity",
    "q_m = q + τ/K + k3 τ³: τ_F and J feel q̇ + d/dt(τ/K + k3 τ³)",
    "stiffness of the flex spline, ROKVISS, lessons learned, Fig. 15",
    coefficients: ["inverse_K": Unit::new("rad/Nm", "m/N"), "c_jerk": Unit::new("s²", "s²"), "k3": Unit::new("rad/Nm³", "m/N³")],
    shape: [],
    shows_as: "over τ and τ̇",
    excited_by: "load that changes fast while the joint hardly moves",
    shown_by: Accelerations,
    taken_for: ["presliding_hysteresis", "channel_delay"]
);

impl Effect for Elasticity {
    fn description(&self) -> &EffectDescription {
        &self.0
    }

    fn evaluate(&self, _shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        // To first order: ∂τ_F/∂q̇ times the speed of winding up.
        if let [linear, inertial, cubic] = columns {
            *linear = point.friction_slope * point.load_rate;
            *inertial = point.load_jerk;
            *cubic = 3.0 * point.load * point.load * *linear;
        }
    }

    fn unavailable(&self, facts: &Facts) -> Option<String> {
        (!facts.joint_torque).then(|| "no joint torque sensor".to_owned())
    }

    fn needs_prediction(&self) -> bool {
        true
    }

    // Softer than 30 Nm/rad it would be no joint; ahead, not behind.
    fn plausible(&self, _shape: &[f64], coefficients: &[f64]) -> bool {
        coefficients.first().is_some_and(|c| *c > 0.0)
    }
}
