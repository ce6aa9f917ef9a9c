//! Why a bench makes no recording.

use thiserror::Error;

/// Why there is no recording.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum BenchError {
    /// No effect has this id.
    #[error("effect \"{id}\" cannot be hidden: choose one of {known}")]
    UnknownEffect {
        /// What was asked for.
        id: String,
        /// What there is, separated by commas.
        known: String,
    },
    /// No motion has this id.
    #[error("there is no motion \"{id}\": choose one of {known}")]
    UnknownMotion {
        /// What was asked for.
        id: String,
        /// What there is, separated by commas.
        known: String,
    },
    /// No kind of recording like a real one has this id.
    #[error("there is no kind of recording \"{id}\": choose one of {known}")]
    UnknownRealLike {
        /// What was asked for.
        id: String,
        /// What there is, separated by commas.
        known: String,
    },
    /// A value is out of bounds.
    #[error("{key} = {value} is out of bounds: choose {low} to {high}")]
    OutOfBounds {
        /// Field of [`BenchConfig`](super::BenchConfig).
        key: &'static str,
        /// What was given.
        value: f64,
        /// Least allowed.
        low: f64,
        /// Most allowed.
        high: f64,
    },
    /// An effect is hidden twice.
    #[error("\"{effect}\" is hidden twice: name each effect once")]
    Twice {
        /// Which.
        effect: &'static str,
    },
    /// No motion is given.
    #[error("motions is empty: name at least one motion, such as \"standard\"")]
    NoMotion,
    /// These effects cannot act together.
    #[error("\"{first}\" and \"{second}\" overlap: both change {shared}; hide one of them")]
    Overlap {
        /// One of the two.
        first: &'static str,
        /// The other.
        second: &'static str,
        /// What both change.
        shared: &'static str,
    },
    /// The joint ran away.
    #[error(
        "the joint ran away in session {session} at {time:.3} s: lower the strength or take another seed"
    )]
    RanAway {
        /// Which session, from 0.
        session: usize,
        /// When \[s\].
        time: f64,
    },
}
