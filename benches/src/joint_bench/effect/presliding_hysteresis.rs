//! Bristles that bend before the joint slides (Dahl 1968 with exponent 1, which
//! is LuGre without damping): dz/dq = (1 − z sign(q̇))/δ, and Coulomb friction is
//! b_0 z. The joint always has bristles, of 0.02°, which nobody sees at 12 ms;
//! here they are long.
//! A loop after each reversal, over travel and not over time.

use ferntast_emulation::random::Random;

use super::{Effect, about};
use crate::joint_bench::parameters::JointParameters;

#[derive(Clone)]
struct PreslidingHysteresis {
    /// δ \[rad\].
    bristle: f64,
}

pub(super) fn draw(strength: f64, random: &mut Random) -> Box<dyn Effect> {
    Box::new(PreslidingHysteresis {
        bristle: strength * about(0.015, random),
    })
}

impl Effect for PreslidingHysteresis {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![("bristle", self.bristle, "rad")]
    }

    fn prepare(&self, joint: &mut JointParameters) {
        joint.bristle += self.bristle;
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}
