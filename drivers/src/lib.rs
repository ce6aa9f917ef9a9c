//! What stands between the arm's topics and an arm: takes `/follower/servo_jf`,
//! publishes `/follower/measured_js`, `/follower/motor_js`, temperatures and
//! the robot's description.
//!
//! [`ArmNode`] is the node, a [`Driver`] the arm behind it: one file or folder each. A
//! driver turns vendor signs, units and offsets, once, and comes with a function that
//! makes it of its kind of arm's file. [`leader`] is the node of an arm that is the master, behind the same drivers.

pub mod check;
mod choice;
mod driver;
pub mod dynamixel;
pub mod feetech;
pub mod leader;
pub mod motors;
mod newest;
mod node;
pub mod process;
pub mod ros2;
mod rows;
pub mod serial_arm;
pub mod simulated;
mod weight;

pub use choice::{Choice, UnknownDriver};
pub use driver::{Driver, DriverCommand, Measures, Reading};
pub use node::{ArmInput, ArmNode, ArmOutput, ArmPorts};
pub use rows::rows;
