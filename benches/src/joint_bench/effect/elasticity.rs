//! Compliance between the motor and the measured position, as where position
//! is measured behind a flexible spline: τ = K δ + K₃ δ³ for a twist δ, and the
//! motor is ahead of the measured position by δ. The measured velocity lacks
//! δ̇, which viscous and inertial terms feel.
//! Over τ and τ̇.

use ferntast_emulation::random::Random;

use super::{Effect, about};
use crate::joint_bench::parameters::{JointParameters, Transmission};

#[derive(Clone)]
struct Elasticity {
    /// K \[Nm/rad\].
    stiffness: f64,
    /// K₃ \[Nm/rad³\].
    cubic_stiffness: f64,
}

pub(super) fn draw(strength: f64, random: &mut Random) -> Box<dyn Effect> {
    Box::new(Elasticity {
        stiffness: about(300.0, random) / strength,
        cubic_stiffness: about(6e4, random) / strength.powi(3),
    })
}

impl Effect for Elasticity {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![
            ("stiffness", self.stiffness, "Nm/rad"),
            ("cubic_stiffness", self.cubic_stiffness, "Nm/rad³"),
        ]
    }

    fn prepare(&self, joint: &mut JointParameters) {
        joint.transmission = Transmission::Elastic {
            stiffness: self.stiffness,
            cubic_stiffness: self.cubic_stiffness,
            // A fifth of critical damping, with the link alone.
            damping: 0.4 * (self.stiffness * joint.link_inertia).sqrt(),
            link_friction: 0.0,
            measures_motor: false,
        };
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}
