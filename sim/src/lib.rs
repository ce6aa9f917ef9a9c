//! The simulated arm, trials of teleoperation, the lockstep executor; seeded.

pub mod arm;
pub mod lockstep;
pub mod teleoperation;
