//! Why a recording is not exported.

use std::{io, path::PathBuf};

use ferntast_bag::{OpenBagError, ReadMessageError, SelectTopicError};

use ferntast_lab::schema::DecodeError;

/// Why a recording is not exported.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// It cannot be opened.
    #[error(transparent)]
    Open(#[from] OpenBagError),
    /// Its messages cannot be read.
    #[error(transparent)]
    Read(#[from] ReadMessageError),
    /// A topic cannot be read.
    #[error(transparent)]
    Select(#[from] SelectTopicError),
    /// The output is there already.
    #[error("{0} exists already: choose another folder")]
    Exists(PathBuf),
    /// Nothing can be exported.
    #[error("{path}: no topic with numbers in it")]
    Nothing {
        /// The recording.
        path: PathBuf,
    },
    /// The recording has no such topic.
    #[error("{path}: no topic {name:?} with numbers; the most alike: {alike}")]
    NoTopic {
        /// The recording.
        path: PathBuf,
        /// What was asked for.
        name: String,
        /// Topics like it.
        alike: String,
    },
    /// The recording has no such number.
    #[error("{path}: no number at {name:?}; the most alike: {alike}")]
    NoNumber {
        /// The recording.
        path: PathBuf,
        /// What was asked for.
        name: String,
        /// Numbers like it.
        alike: String,
    },
    /// A message does not fit its type.
    #[error("{topic}, message {message}: {source}")]
    Decode {
        /// The topic.
        topic: String,
        /// Counted from 1.
        message: usize,
        /// What is wrong.
        source: DecodeError,
    },
    /// A rate that is none.
    #[error("--rate {0}: give a positive number of rows in a second, 10000 at most")]
    Rate(f64),
    /// A rate that a dataset cannot have.
    #[error("--rate {0}: frames of a dataset come at a whole number a second")]
    WholeRate(f64),
    /// More than is held at once.
    #[error(
        "{rows} rows of {columns} columns are more than is held at once: name --topics, or a lower --rate"
    )]
    Large {
        /// Rows.
        rows: usize,
        /// Columns.
        columns: usize,
    },
    /// A recording says nothing of what a dataset consists of.
    #[error(
        "{path}: name what a dataset consists of: --state and --action with message paths, as in --action '/joint_commands.position[0]'"
    )]
    Unsaid {
        /// The recording.
        path: PathBuf,
    },
    /// Not all signals are there at any one time.
    #[error("{path}: there is no time at which all of {signals} had been heard")]
    Never {
        /// The recording.
        path: PathBuf,
        /// The signals.
        signals: String,
    },
    /// A file cannot be written.
    #[error("cannot write {path}: {source}")]
    File {
        /// Which.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
}

impl ExportError {
    /// Turns what the system said of the file at `path`.
    pub(super) fn file(path: impl Into<PathBuf>) -> impl FnOnce(io::Error) -> ExportError {
        let path = path.into();
        |source| ExportError::File { path, source }
    }
}

/// Of `names` the eight that are most like `wanted`, the most alike first.
pub(crate) fn nearest<'a>(wanted: &str, names: impl Iterator<Item = &'a str>) -> String {
    let mut names: Vec<&str> = names.collect();
    // Of equals, in the order of the recording.
    names.sort_by_key(|name| strsim::damerau_levenshtein(wanted, name));
    names.truncate(8);
    names.join(", ")
}
