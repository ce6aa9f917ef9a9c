//! A weight on the joint.

use super::{
    Direction, Effect, EffectDescription, Facts, Memory, OwnSignals, Point, TORQUE, describe,
};

describe!(
    Gravity,
    "gravity",
    "τ = g_s · sin q + g_c · cos q = g · sin(q + φ)",
    "rigid body",
    coefficients: ["g_s": TORQUE, "g_c": TORQUE],
    shape: [],
    shows_as: "over q, whatever the sign of q̇",
    excited_by: "slow motion over the widest arc that the joint allows",
    shown_by: WidePosition,
    taken_for: ["cable_spring"]
);

impl Effect for Gravity {
    fn description(&self) -> &EffectDescription {
        &self.0
    }

    fn evaluate(&self, _shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        if let [sine, cosine] = columns {
            (*sine, *cosine) = point.position.sin_cos();
        }
    }

    fn unavailable(&self, facts: &Facts) -> Option<String> {
        (facts.joint == crate::data::JointType::Prismatic)
            .then(|| "on a prismatic joint a weight is a constant: asymmetric_coulomb".to_owned())
    }

    fn is_load(&self) -> bool {
        true
    }

    fn own_signals(&self) -> OwnSignals {
        OwnSignals {
            names: &["position"],
            direction: Direction::Same,
            any_pair: false,
        }
    }
}
