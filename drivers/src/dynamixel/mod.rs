//! Robotis' Dynamixel X series over Protocol 2.0, in the current-based position mode with the bus
//! watchdog on: `docs/motors.md`.

pub mod models;
pub mod packet;
pub mod registers;

mod motors;

pub use motors::Dynamixel;

/// What it is called in an arm's file and after `--driver`.
pub const NAME: &str = "dynamixel";
