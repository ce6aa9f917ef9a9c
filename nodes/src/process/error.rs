//! Why a node does not run.

use std::path::PathBuf;

use ferntast_bus::{CreateError, OpenError};
use ferntast_config::ConfigError;
use ferntast_model::ParameterError;

use super::link_keys::LinkKeyError;

/// Why a node cannot be made, or stopped running.
#[derive(Debug, thiserror::Error)]
pub enum NodeError {
    /// A bus cannot be opened.
    #[error(transparent)]
    Open(#[from] OpenError),
    /// A topic cannot be opened.
    #[error(transparent)]
    Create(#[from] CreateError),
    /// A parameter is out of its bounds.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The configuration cannot be used.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// There are no keys for the link.
    #[error(transparent)]
    LinkKeys(#[from] LinkKeyError),
    /// What is the node's own cannot be made: a model, a server, a simulation.
    #[error("{0}")]
    Own(Box<dyn std::error::Error + Send + Sync>),
    /// A recording is needed and none is named.
    #[error("no recording is named: give --bag DIR")]
    NoBag,
    /// An address is needed and none is given.
    #[error("no address is given for Foxglove: give --foxglove")]
    NoFoxglove,
    /// An experiment is needed and none is named.
    #[error("no experiment is named: give --twin EXPERIMENT.toml")]
    NoTwin,
    /// An end of the link is asked for where there is no link, or a second time.
    #[error("there is no link for this end, or its other end is taken")]
    NoLink,
    /// A recording cannot be opened or created.
    #[error("{path}: {reason}")]
    Bag {
        /// The recording.
        path: PathBuf,
        /// What is wrong, and how to correct it.
        reason: String,
    },
    /// It failed while it ran.
    #[error("{0}")]
    Broken(String),
}

impl NodeError {
    /// What keeps one kind of node from being made.
    pub fn own(error: impl std::error::Error + Send + Sync + 'static) -> NodeError {
        NodeError::Own(Box::new(error))
    }
}
