//! The option by which topics are shown to Foxglove.

use std::net::SocketAddr;

use clap::Args;

use super::Failure;

/// Whether topics are shown to Foxglove, and where.
#[derive(Debug, Args)]
pub struct FoxgloveOption {
    /// Show every topic to Foxglove or Lichtblick over a WebSocket there (alone: 127.0.0.1:8765).
    /// Loopback only: its protocol knows no password.
    #[arg(
        long,
        value_name = "ADDRESS:PORT",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "127.0.0.1:8765"
    )]
    foxglove: Option<SocketAddr>,
}

impl FoxgloveOption {
    /// The address, checked.
    ///
    /// # Errors
    ///
    /// One beyond loopback.
    pub fn address(&self) -> Result<Option<SocketAddr>, Failure> {
        match self.foxglove {
            Some(address) if !address.ip().is_loopback() => {
                Err(Failure::refused(ferntast_bus::OpenError::NotLoopback {
                    address,
                }))
            }
            address => Ok(address),
        }
    }
}
