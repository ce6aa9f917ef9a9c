//! What stands between the arm's topics and an arm: takes `/follower/servo_jf`,
//! publishes `/follower/measured_js`, `/follower/motor_js`, temperatures and
//! the robot's description.
//!
//! [`ArmNode`] is the node, a [`Driver`] the arm behind it: one file or folder each. A
//! driver turns vendor signs, units and offsets, once, and comes with a function that
//! makes it of its kind of arm's file.

pub mod check;
mod choice;
mod driver;
pub mod dynamixel;
pub mod feetech;
pub mod motors;
mod node;
pub mod process;
pub mod ros2;
pub mod serial_arm;
pub mod simulated;
mod weight;

pub use choice::{Choice, UnknownDriver, row};
pub use driver::{Driver, DriverCommand, Measures, Reading};
pub use node::{ArmInput, ArmNode, ArmOutput, ArmPorts};
