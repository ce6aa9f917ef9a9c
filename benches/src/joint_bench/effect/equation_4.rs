//! The terms of equation (4) as hidden effects: the truth has them anyway, the
//! believed model lacks one.
//!
//! A step at q̇ = 0 (`coulomb`), one that grows with the load (`load_coulomb`),
//! a slope, a curvature and an S over q̇ (the viscous terms).
//!
//! Table 1's viscous terms are dissipative only together. Strength therefore
//! scales the hidden one with those that it has to be in balance with.

use super::Effect;
use crate::joint_bench::HiddenEffect;
use crate::joint_bench::parameters::JointParameters;

#[derive(Clone)]
struct Equation4 {
    hidden: HiddenEffect,
    strength: f64,
    /// With Table 1's full values.
    joint: JointParameters,
}

pub(super) fn draw(
    hidden: HiddenEffect,
    strength: f64,
    joint: &JointParameters,
) -> Box<dyn Effect> {
    Box::new(Equation4 {
        hidden,
        strength,
        joint: joint.clone(),
    })
}

impl Effect for Equation4 {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        let mut joint = self.joint.clone();
        self.prepare(&mut joint);
        let [b0, b0t, b1, b2, b3] = joint.named();
        match self.hidden {
            HiddenEffect::Coulomb => vec![b0],
            HiddenEffect::LoadCoulomb => vec![b0t],
            HiddenEffect::Viscous => vec![b1],
            HiddenEffect::QuadraticViscous => vec![b2],
            HiddenEffect::CubicViscous => vec![b3],
            _ => vec![b2, b3],
        }
    }

    fn prepare(&self, joint: &mut JointParameters) {
        let factor = self.strength;
        match self.hidden {
            HiddenEffect::Coulomb => joint.b0 *= factor,
            HiddenEffect::LoadCoulomb => joint.b0t *= factor,
            HiddenEffect::Viscous => {
                joint.b1 *= factor;
                joint.b2 *= factor;
                joint.b3 *= factor;
            }
            // Above full strength b_2 would drive the joint.
            HiddenEffect::QuadraticViscous => {
                joint.b2 *= factor;
                joint.b3 *= factor.max(1.0);
                joint.b1 *= factor.max(1.0);
            }
            _ => {
                joint.b2 *= factor;
                joint.b3 *= factor;
                joint.b1 *= factor.max(1.0);
            }
        }
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}
