//! What is run for its result, in virtual time: identification experiments and
//! campaigns, the paper's items, sweeps over delay laws, schedules of
//! faults, the lab's challenges, a scenario alone.

pub mod challenge;
pub mod experiment;
pub mod faults;
pub mod lockstep;
pub mod paper;
pub mod parallel;
pub mod sweep;
