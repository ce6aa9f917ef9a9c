//! A dead zone between the motor, whose position is measured, and gear with
//! load. While the motor crosses it, neither friction nor load acts on the motor.
//! A jump after each reversal of the torque that the gear transmits.

use ferntast_emulation::random::Random;

use super::{Effect, about};
use crate::joint_bench::parameters::{JointParameters, Transmission};

#[derive(Clone)]
struct Backlash {
    /// Width of the dead zone \[rad\].
    gap: f64,
}

pub(super) fn draw(strength: f64, random: &mut Random) -> Box<dyn Effect> {
    Box::new(Backlash {
        gap: strength * about(0.02, random),
    })
}

impl Effect for Backlash {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![("gap", self.gap, "rad")]
    }

    fn prepare(&self, joint: &mut JointParameters) {
        joint.transmission = Transmission::Backlash { gap: self.gap };
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}
