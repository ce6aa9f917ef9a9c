//! The nodes, their supervisor and the ferntast command.

pub mod clock;
pub mod doctor;
