//! Simulated arms, trials of teleoperation; seeded.

pub mod arm;
pub mod serial_arm;
pub mod teleoperation;
