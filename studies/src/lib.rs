//! What is run for its result, in virtual time: identification experiments and
//! campaigns, the paper's items, sweeps over delay laws, schedules of
//! faults, the lab's challenges, a scenario alone; in one go or in parts.

pub mod challenge;
pub mod experiment;
pub mod faults;
pub mod lab_folder;
pub mod lockstep;
pub mod paper;
pub mod parallel;
pub mod shard;
pub mod sweep;
