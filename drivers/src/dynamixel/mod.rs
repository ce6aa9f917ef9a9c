//! Robotis' Dynamixel X series over Protocol 2.0, in the current-based position mode with the bus
//! watchdog on: `docs/motors.md`.

pub mod models;
pub mod packet;
pub mod registers;

mod motors;

pub use motors::Dynamixel;

use ferntast_nodes::{graph::Build, node::Ticking, process::NodeError};

use crate::motors::MotorArm;

/// What it is called in an arm's file and after `--driver`.
pub const NAME: &str = "dynamixel";

/// The node of the arm that the session is of.
pub(crate) fn make(build: Build) -> Result<Box<dyn Ticking>, NodeError> {
    MotorArm::node(build, NAME, Dynamixel::open)
}
