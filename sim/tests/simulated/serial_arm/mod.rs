//! The simulated serial arm against laws of mechanics, and against the arm of two joints,
//! which integrates its own equations in another way.

pub mod arms;
mod contact;
mod errors;
mod grip;
mod mechanics;
mod two_joints;

use crate::common::TICK;
use ferntast_model::{Joints, rigid_body::Chain};
use ferntast_sim::serial_arm::{SerialArm, SerialArmParameters};

/// What a file says; the rest is left out.
fn parameters(text: &str) -> SerialArmParameters {
    toml::from_str(text).expect("parameters")
}

fn arm(chain: &Chain, text: &str) -> SerialArm {
    SerialArm::new(chain, &arms::any_torque(chain), &parameters(text), 1).expect("an arm")
}

fn no_torque(chain: &Chain) -> Joints<f64> {
    Joints::filled(chain.count(), 0.0)
}
