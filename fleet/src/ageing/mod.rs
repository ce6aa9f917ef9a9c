//! Which joint ages differently from its siblings. Pure: days in, findings out.
//!
//! The same parameter of the same joint is followed on all robots, day by day. Each is
//! modelled by a level of its own, a slope and a curvature with temperature of its own,
//! a drift of its own (normal ageing differs, too), a wander that fades within days, a
//! random walk, and noise; what the siblings do together is taken out by a robust
//! location of their innovations. How far robots differ in all that is estimated from
//! the fleet itself (empirical Bayes, [`spread`]), so that a robot whose slope is not
//! known yet may go as far as a slope could take it. A change is a ramp on top of that,
//! tested for every day on which it may have begun by the likelihood ratio of a
//! linear Gaussian model (Willsky and Jones, "A generalized likelihood ratio approach to
//! the detection and estimation of jumps in linear systems", IEEE TAC 21, 1976, with a
//! ramp in place of their jump), on innovations bounded as Huber's.

mod filter;
mod fit;
mod group;
mod location;
mod onsets;
mod pass;
mod series;
mod spread;
mod states;
#[cfg(test)]
mod tests;
mod threshold;
mod watch;

pub use spread::Spread;
pub use threshold::{false_alarms, threshold};
pub use watch::{DayError, Finding, Kind, Reading, Standing, Watch, WatchSettings};
