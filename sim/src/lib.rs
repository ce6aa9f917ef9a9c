//! The simulated arm, trials of teleoperation; seeded.

pub mod arm;
pub mod teleoperation;
