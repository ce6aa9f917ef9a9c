//! The options by which a page is served.

use std::net::SocketAddr;

use clap::Args;
use ferntast_console::Listen;
use ferntast_nodes::process::ConsoleOptions;

use super::Failure;

/// Where the page is served, and to whom.
#[derive(Debug, Args)]
pub struct PageOptions {
    /// Serve the page there (else at the first free port of 127.0.0.1 from 8080 on). Beyond
    /// loopback it needs --token.
    #[arg(long, value_name = "ADDRESS:PORT")]
    pub listen: Option<SocketAddr>,

    /// What pages have to show: 16 or more letters, digits, '-' or '_'.
    #[arg(long, value_name = "WORD")]
    pub token: Option<String>,
}

impl PageOptions {
    /// The options, checked.
    ///
    /// # Errors
    ///
    /// Listening beyond loopback without a token; a token that can be guessed.
    pub fn console(self) -> Result<ConsoleOptions, Failure> {
        let listen = Listen {
            address: self.listen,
            token: self.token,
        };
        listen.check().map_err(Failure::refused)?;
        Ok(ConsoleOptions {
            listen: listen.address,
            token: listen.token,
        })
    }
}
