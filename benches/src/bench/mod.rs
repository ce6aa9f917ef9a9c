//! What the benches share: how a recording is asked for, when and how warm
//! sessions are, how motions are laid out, how random numbers are drawn.

mod conditions;
mod config;
mod error;
mod exchange;
mod hidden;
mod named;
mod parameter;
mod programme;
mod smooth;
mod streams;

pub use config::BenchConfig;
pub use error::BenchError;
pub use hidden::Hideable;
pub use parameter::TrueParameter;

pub(crate) use conditions::{Conditions, SECONDS_A_DAY};
pub(crate) use exchange::exchange;
pub(crate) use named::named;
pub(crate) use programme::Programme;
pub(crate) use smooth::{differentiate, rms, smooth};
pub(crate) use streams::{Stream, about, either_sign, random};

/// Period of the log \[s\]: the paper's.
pub const LOG_PERIOD: f64 = 0.012;
/// Milliseconds between two log entries.
pub(crate) const MILLISECONDS_A_LOG: usize = 12;
