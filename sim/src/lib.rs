//! Seeded stand-ins for what is not there: arm, hand, channel; the lockstep executor.

pub mod arm;
pub mod bench;
pub mod channel;
pub mod contact_bench;
pub mod flexible_joint_bench;
pub mod hand;
pub mod joint_bench;
pub mod lockstep;
mod random;
pub mod teleoperation;
