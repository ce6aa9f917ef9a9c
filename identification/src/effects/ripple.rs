//! Torque that is periodic in position: wave generator, teeth, screw.

use super::{Effect, EffectDescription, Facts, Memory, Point, TORQUE, Unit, describe};

describe!(
    Ripple,
    "ripple",
    "τ_F = a_s · sin(k q) + a_c · cos(k q)",
    "wave generator of a harmonic drive: k = 2N, also N and 4N, N the gear ratio",
    coefficients: ["a_s": TORQUE, "a_c": TORQUE],
    shape: ["k": Unit::new("1/rad", "1/m")],
    shows_as: "periodic in q",
    excited_by: "slow constant speed, so slow that the ripple is not aliased",
    shown_by: WidePosition,
    taken_for: ["local_friction"]
);

impl Effect for Ripple {
    fn description(&self) -> &EffectDescription {
        &self.0
    }

    fn evaluate(&self, shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        if let ([sine, cosine], [k, ..]) = (columns, shape) {
            (*sine, *cosine) = (k * point.position).sin_cos();
        }
    }

    // Other periods are found from the residual, see `crate::periodic`.
    fn shapes(&self, facts: &Facts) -> Vec<Vec<f64>> {
        let turn = match facts.joint {
            crate::data::JointType::Revolute => 1.0,
            // Per metre of travel: the gear ratio is motor turns a screw turn,
            // whose lead is not known; only the free search applies.
            crate::data::JointType::Prismatic | crate::data::JointType::Contact => {
                return Vec::new();
            }
        };
        facts.gear_ratio.map_or_else(Vec::new, |ratio| {
            [1.0, 2.0, 4.0]
                .into_iter()
                .map(|times| vec![times * ratio * turn])
                .filter(|shape| shape[0] * facts.travel() > 9.0)
                .collect()
        })
    }

    fn bounds(&self, facts: &Facts) -> Vec<[f64; 2]> {
        // A few turns at least, else it is a slope; more than a few samples a
        // turn at the slowest speed, else it is aliased.
        let low = 9.0 / facts.travel();
        let finest = 800.0 * std::f64::consts::TAU / facts.travel();
        let high = f64::min(1.5 / (facts.speed[0] * facts.period), finest);
        vec![[low, high.max(2.0 * low)]]
    }
}
