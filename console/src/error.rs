//! Why the page is not served.

use std::{io, net::SocketAddr, path::PathBuf};

/// Why the page is not served.
#[derive(Debug, thiserror::Error)]
pub enum ServerError {
    /// Others could reach it, and it asks nothing of them.
    #[error(
        "--listen {0}: beyond this machine's loopback a token is needed; give --token WORD (16 characters or more)"
    )]
    NoToken(SocketAddr),
    /// The token can be guessed, or cannot be part of an address.
    #[error("--token: use 16 or more letters, digits, '-' or '_'")]
    WeakToken,
    /// The port is taken, or not ours to have.
    #[error("cannot listen at {address}: {source}; choose another with --listen")]
    Listen {
        /// Where.
        address: SocketAddr,
        /// What the system said.
        source: io::Error,
    },
    /// The folder of the lab is none.
    #[error("{path}: {source}")]
    Folder {
        /// The folder.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The server cannot run.
    #[error("the page cannot be served: {0}")]
    Run(io::Error),
}
