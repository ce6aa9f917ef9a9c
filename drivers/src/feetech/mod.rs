//! Feetech's STS motors (SO-100, SO-101), in their position mode: `docs/motors.md`.

pub mod packet;
pub mod registers;

mod motors;

pub use motors::Feetech;

use ferntast_nodes::{graph::Build, node::Ticking, process::NodeError};

use crate::motors::MotorArm;

/// What it is called in an arm's file and after `--driver`.
pub const NAME: &str = "feetech";

/// The node of the arm that the session is of.
pub(crate) fn make(build: Build) -> Result<Box<dyn Ticking>, NodeError> {
    MotorArm::node(build, NAME, Feetech::open)
}
