//! Inertia that the believed model does not have: ΔJ q̈.
//! A slope over q̈.

use ferntast_emulation::random::Random;

use super::{Effect, about};
use crate::joint_bench::parameters::JointParameters;

#[derive(Clone)]
struct Inertia {
    /// ΔJ \[kg m²\].
    dj: f64,
}

pub(super) fn draw(strength: f64, random: &mut Random) -> Box<dyn Effect> {
    Box::new(Inertia {
        dj: strength * about(1.3, random),
    })
}

impl Effect for Inertia {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![("dj", self.dj, "kg m²")]
    }

    fn prepare(&self, joint: &mut JointParameters) {
        joint.inertia += self.dj;
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}
