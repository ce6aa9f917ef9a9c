//! Why an experiment file cannot be read or written.

use std::{io, path::PathBuf};

use ferntast_bag::OpenBagError;

/// Why there is no experiment.
#[derive(Debug, thiserror::Error)]
pub enum ExperimentError {
    /// The file cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A recording in place of an experiment file.
    #[error("{} is a recording, not an experiment file: make one first: ferntast lab new {}", path.display(), path.display())]
    IsRecording {
        /// The recording.
        path: PathBuf,
    },
    /// Not TOML, a key that is not known or missing, a value of a wrong type.
    #[error("{}: {message}", path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// Line, key, and what is wrong.
        message: String,
    },
    /// A value is out of its bounds, or does not fit the others.
    #[error("{}: {key}: {reason}", path.display())]
    Value {
        /// The file.
        path: PathBuf,
        /// The key.
        key: String,
        /// What is wrong, and how to correct it.
        reason: String,
    },
    /// The recording that should stand for an experiment cannot be opened.
    #[error(transparent)]
    Open(#[from] OpenBagError),
    /// The recording does not say how it came about.
    #[error("{} was not recorded by ferntast, so its signals must be named: ferntast lab new {}; numbers that it has: {}", path.display(), path.display(), available.join(", "))]
    NotOurs {
        /// The recording.
        path: PathBuf,
        /// Paths of numbers that there are.
        available: Vec<String>,
    },
    /// The recording's own record cannot be used.
    #[error("{}: its record \"ferntast\" cannot be used: {reason}; write an experiment file", path.display())]
    Record {
        /// The recording.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// A file descends from itself.
    #[error("{}: the files in lineage.parent lead back to it: write it under another name", path.display())]
    Circle {
        /// The file.
        path: PathBuf,
    },
}

/// Why a new experiment file was not written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// Only a file can be continued.
    #[error("a recording alone has no experiment file to go on from: write one first")]
    NoParent,
    /// It would take its parent's place.
    #[error("{} is the experiment itself: choose another name, its history would be lost", path.display())]
    OverParent {
        /// The file.
        path: PathBuf,
    },
    /// The parent has changed since it was read.
    #[error("{} cannot be read again: {reason}", path.display())]
    Parent {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// The effect is in the model already.
    #[error("{effect} is in the model already")]
    Twice {
        /// The effect.
        effect: String,
    },
    /// The recordings cannot be read for their hash.
    #[error("cannot read {}: {source}", path.display())]
    Data {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The system refuses.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
}
