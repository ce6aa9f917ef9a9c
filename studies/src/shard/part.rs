//! The file of a part.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize};

use super::{Shard, Study};

/// A part of a study, answered. As a file it is TOML, which keeps every number as it is.
#[derive(Serialize, Deserialize)]
#[serde(bound = "")]
pub struct Part<S: Study> {
    /// Version of the program that answered.
    pub ferntast: String,
    /// What the study is.
    pub kind: String,
    /// Which part.
    pub shard: Shard,
    /// What was asked.
    pub study: S,
    /// What was found; where nothing is to be told of a question, it may be left out.
    #[serde(default = "Vec::new")]
    pub answer: Answers<S>,
}

/// An answer and the place of its question among all.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Placed<A> {
    /// From 0 on.
    pub place: u64,
    /// The answer.
    pub value: A,
}

/// Answers to a study's questions.
pub type Answers<S> = Vec<Placed<<S as Study>::Answer>>;

/// The answers, without their places.
pub fn values<A>(answers: Vec<Placed<A>>) -> Vec<A> {
    answers.into_iter().map(|own| own.value).collect()
}

/// Why a part is not written or read.
#[derive(Debug, thiserror::Error)]
pub enum PartError {
    /// The file is out of reach.
    #[error("{path}: {source}")]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// It holds something else.
    #[error("{path} is no part that `--shard` writes: {reason}")]
    NoPart {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
}

impl<S: Study> Part<S> {
    /// What was found of a part of `study`.
    pub fn new(study: S, shard: Shard, answer: Answers<S>) -> Part<S> {
        Part {
            ferntast: env!("CARGO_PKG_VERSION").to_owned(),
            kind: S::KIND.to_owned(),
            shard,
            study,
            answer,
        }
    }

    /// Writes it.
    ///
    /// # Errors
    ///
    /// The file cannot be written, or a number is too large for it.
    pub fn write(&self, path: &Path) -> Result<(), PartError> {
        let text = toml::to_string(self).map_err(|error| no_part(path, &error))?;
        fs::write(path, text).map_err(|source| PartError::File {
            path: path.to_owned(),
            source,
        })
    }

    /// Reads it.
    ///
    /// # Errors
    ///
    /// The file cannot be read, or is of another kind.
    pub fn read(path: &Path) -> Result<Part<S>, PartError> {
        toml::from_str(&text(path)?).map_err(|error| no_part(path, &error))
    }
}

pub(super) fn text(path: &Path) -> Result<String, PartError> {
    fs::read_to_string(path).map_err(|source| PartError::File {
        path: path.to_owned(),
        source,
    })
}

pub(super) fn no_part(path: &Path, error: &impl ToString) -> PartError {
    PartError::NoPart {
        path: path.to_owned(),
        reason: error.to_string().trim().to_owned(),
    }
}
