//! The lab's benches, seeded: joints and contacts with a known truth, whose
//! recordings the identification is put to. It shares no code with them.

pub mod bench;
pub mod contact_bench;
pub mod flexible_joint_bench;
pub mod joint_bench;
