//! Deterministic disasters: the nodes of both ends on two hosts of their own, in
//! virtual time, while things go wrong by a seeded schedule.
//!
//! From the bottom up: [`Fault`] and [`Schedule`] say what goes wrong and when;
//! `host`, `wire`, `arm`, `gateway` and `recorder` are what it goes wrong with;
//! `world` puts them together and steps them; `seen`, `log` and `facts` are what
//! an invariant looks at (`invariants/`, one a file); `run` runs schedules by
//! the thousand, [`shrink`] makes one that fails small.
//!
//! Nodes are the shipped ones, made of the rows of the graph. Each host has a bus
//! and a clock of its own; only frames of the link cross, over a wire that is
//! this module's. The same schedule gives the same bytes.

mod arm;
mod body;
mod clock;
mod digest;
mod draw;
mod facts;
mod fault;
mod gateway;
mod host;
mod invariants;
mod keys;
mod kit;
mod log;
mod recorder;
mod results;
mod run;
mod schedule;
mod seen;
mod shrink;
mod study;
mod summary;
#[cfg(test)]
mod tests;
mod truth;
mod violation;
mod wire;
mod world;

pub use fault::{Fault, Node, Way};
pub use kit::{KitError, load};
pub use results::Results;
pub use run::{Kits, Look, Outcome, Plan, RunError, replay, run_many};
pub use schedule::{Event, Schedule, ScheduleError};
pub use shrink::{shrink, shrink_where, violates};
pub use study::FaultStudy;
pub use summary::{Found, Summary};
pub use violation::Violation;
