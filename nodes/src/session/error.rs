//! Why a session does not run.

use std::{io, path::PathBuf};

use ferntast_bus::{CleanUpError, CreateError, OpenError};

use super::{SupervisorError, private_folder::PrivateFolderError};
use crate::process::ContextError;

/// Why a session did not run, or not to its end.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// The session's file cannot be written.
    #[error(transparent)]
    Context(#[from] ContextError),
    /// The folder for the session's file is not this user's alone.
    #[error(transparent)]
    PrivateFolder(#[from] PrivateFolderError),
    /// What marks the session's name as taken cannot be written.
    #[error("cannot write {path}: {source}")]
    Folder {
        /// The file.
        path: PathBuf,
        /// The operating system's reason.
        source: io::Error,
    },
    /// Another session of that name runs, or its remains cannot be removed.
    #[error(transparent)]
    Taken(#[from] CleanUpError),
    /// The recording's folder exists.
    #[error("{path} exists already: choose another folder for --record, or remove it")]
    RecordingExists {
        /// The folder.
        path: PathBuf,
    },
    /// A port is taken by another program.
    #[error(
        "{what} {endpoint} is taken ({source}): stop what listens there, or choose another with {option}"
    )]
    PortTaken {
        /// What it is for.
        what: &'static str,
        /// The endpoint.
        endpoint: String,
        /// The operating system's reason.
        source: io::Error,
        /// The option that chooses another.
        option: &'static str,
    },
    /// The bus cannot be opened.
    #[error(transparent)]
    Open(#[from] OpenError),
    /// A topic cannot be opened.
    #[error(transparent)]
    Create(#[from] CreateError),
    /// The nodes cannot be kept running.
    #[error(transparent)]
    Supervisor(#[from] SupervisorError),
    /// The nodes were not all alive, or the arm not armed, in time.
    #[error(
        "not ready after {waited:.0} s, the last {seconds} s of them without progress: {waiting}"
    )]
    NotReady {
        /// How long it was waited \[s\].
        waited: f64,
        /// How long nothing had changed \[s\].
        seconds: f64,
        /// For what.
        waiting: String,
    },
    /// The session came to its end, but what it recorded is not whole.
    #[error("the recording is not whole: {}", faults.join("; "))]
    Recording {
        /// Why, in words.
        faults: Vec<String>,
    },
    /// The program's own path is not known.
    #[error("cannot find the ferntast program itself: {0}")]
    Executable(io::Error),
}

impl SessionError {
    /// Whether the input or the surroundings were refused, before anything moved.
    pub fn is_refusal(&self) -> bool {
        !matches!(
            self,
            SessionError::NotReady { .. }
                | SessionError::Supervisor(_)
                | SessionError::Recording { .. }
        ) || matches!(
            self,
            SessionError::Supervisor(SupervisorError::Refused { .. })
        )
    }
}
