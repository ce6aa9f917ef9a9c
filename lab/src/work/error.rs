//! Why work on an experiment does not go on.

use std::path::PathBuf;

use ferntast_identification::PrepareError;

use crate::{
    experiment::{ExperimentError, WriteError},
    recording::LoadError,
};

/// Why work on an experiment does not go on.
#[derive(Debug, thiserror::Error)]
pub enum WorkError {
    /// The experiment file cannot be used.
    #[error(transparent)]
    Experiment(#[from] ExperimentError),
    /// A recording cannot be used.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// A CSV file cannot be used.
    #[error(transparent)]
    Csv(#[from] crate::csv::CsvError),
    /// The data or the model lack something.
    #[error("{title}: {source}")]
    Prepare {
        /// The experiment.
        title: String,
        /// What is lacking.
        source: Box<PrepareError>,
    },
    /// The new experiment file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A new file would lie over another one.
    #[error("{path} exists already: choose another name")]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// A file cannot be written.
    #[error("cannot write {path}: {source}")]
    File {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The recording holds no joint.
    #[error("{path}: no joint in it")]
    NoJoint {
        /// The recording.
        path: PathBuf,
    },
    /// The recording says nothing of a twin.
    #[error(
        "{path}: nothing of a twin in it: record a session that runs with --twin EXPERIMENT.toml"
    )]
    NoTwin {
        /// The recording.
        path: PathBuf,
    },
    /// The twin in the recording is not that of the experiment.
    #[error("{path}: {reason}; name the experiment that the twin was started with")]
    OtherModel {
        /// The recording.
        path: PathBuf,
        /// What does not go together.
        reason: String,
    },
    /// What the twin said cannot be read.
    #[error("{path}: {reason}")]
    Twin {
        /// The recording.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// A custom effect is not described as it has to be.
    #[error("{0}")]
    OwnEffect(String),
}
