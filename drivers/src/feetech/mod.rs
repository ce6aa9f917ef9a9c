//! Feetech's STS motors (SO-100, SO-101), in their position mode: `docs/motors.md`.

pub mod packet;
pub mod registers;

mod motors;

pub use motors::Feetech;

/// What it is called in an arm's file and after `--driver`.
pub const NAME: &str = "feetech";
