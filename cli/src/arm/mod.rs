//! `ferntast arm`.

mod check;
mod terminal;

use std::process::ExitCode;

use clap::Subcommand;

use crate::Failure;

/// Look at an arm before a session moves it.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    /// Read everything of an arm for some seconds and say what is implausible; with --move, move it a little.
    Check(check::Arguments),
}

/// Runs it.
pub fn run(arguments: Arguments, json: bool) -> Result<ExitCode, Failure> {
    match arguments.what {
        What::Check(arguments) => check::run(&arguments, json),
    }
}
