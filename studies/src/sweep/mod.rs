//! Delay laws held against each other: every law over every delay, jitter,
//! loss and environment, in simulation and virtual time.
//!
//! A row is one trial of [`ferntast_sim::teleoperation`]: laws and frames as in a session, a
//! hand with impedance, an arm behind its servo, something to touch. The same file gives the
//! same rows, whatever the number of processors. [`RandomSweep`] draws the conditions instead; [`arms`]
//! holds arms out of URDFs against each other.

pub mod arms;
mod bench;
mod config;
mod grid;
mod page;
mod random;
mod row;
mod run;
mod stable;
mod table;
#[cfg(test)]
mod tests;

pub use bench::Bench;
pub use config::{NotSwept, SweepConfig};
pub use grid::Condition;
pub use page::{RenderError, render};
pub use random::{BOUND, Case, RandomCases, RandomSweep, random_table};
pub use row::Row;
pub use run::{RunError, run};
pub use stable::{LargestStable, largest_stable};
pub use table::table;
