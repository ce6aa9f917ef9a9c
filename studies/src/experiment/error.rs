//! Why an experiment failed.

use std::{io, path::PathBuf};

use ferntast_bus::CreateError;
use ferntast_lab::recording::LoadError;
use ferntast_model::{ParameterError, kinematics::InverseError};

use ferntast_config::ConfigError;
use ferntast_nodes::lockstep::RunError;

/// Why an experiment cannot be run.
#[derive(Debug, thiserror::Error)]
pub enum ExperimentError {
    /// The arm's configuration cannot be used.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// A number is out of its bounds.
    #[error("experiment: {0}")]
    Parameter(#[from] ParameterError),
    /// A node cannot be put in place.
    #[error(transparent)]
    Run(#[from] RunError),
    /// A topic cannot be opened.
    #[error(transparent)]
    Topic(#[from] CreateError),
    /// The contour has no such feature.
    #[error(
        "the arm's contour has no {what}; add one to [contour] of its file, or take another experiment"
    )]
    NoFeature {
        /// What is missing.
        what: &'static str,
    },
    /// A point of the motion cannot be reached.
    #[error("the motion does not fit the arm: {0}; move the contour nearer")]
    Reach(#[from] InverseError),
    /// The servo left the enabled state on the way.
    #[error(
        "{kind}: the servo stopped {time:.2} s after the start, {reason}; the recording {path} shows how"
    )]
    Stopped {
        /// The experiment.
        kind: &'static str,
        /// Virtual time since the start \[s\].
        time: f64,
        /// The servo's reason.
        reason: String,
        /// The recording.
        path: PathBuf,
    },
    /// The recording cannot be written.
    #[error("recording {path}: {reason}")]
    Recording {
        /// The rosbag2 directory.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// A folder or a file cannot be written.
    #[error("cannot write {path}: {source}")]
    Write {
        /// The folder or file.
        path: PathBuf,
        /// The operating system's reason.
        source: io::Error,
    },
}

/// Why a recording says nothing.
#[derive(Debug, thiserror::Error)]
pub enum IdentifyError {
    /// It is no recording, or none of ours.
    #[error(transparent)]
    Experiment(#[from] ferntast_lab::experiment::ExperimentError),
    /// The recording cannot be opened.
    #[error("{path}: {reason}")]
    Open {
        /// The recording.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// The recording cannot be read.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// The model cannot be fitted to it.
    #[error("{path}: {source}")]
    Fit {
        /// The recording.
        path: PathBuf,
        /// Why.
        source: ferntast_identification::PrepareError,
    },
    /// There is nothing in it to fit to.
    #[error("{path}: {what}")]
    Empty {
        /// The recording.
        path: PathBuf,
        /// What is missing, and how to get it.
        what: &'static str,
    },
}
