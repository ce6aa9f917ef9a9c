//! `ferntast bag`.

use std::{path::PathBuf, process::ExitCode};

use ferntast_bus::mcap;

use super::{Failure, output::print_json};

/// Look into recordings, mend them.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, clap::Subcommand)]
enum Action {
    /// What a recording holds: topics, types, counts, rates, gaps.
    Info {
        /// A rosbag2 directory or an .mcap file.
        recording: PathBuf,
    },
    /// Recover what a recording that was cut off holds.
    Repair {
        /// A rosbag2 directory or an .mcap file.
        recording: PathBuf,
        /// Write the mended recording there (else in its place; what was broken is kept beside it).
        #[arg(short, long, value_name = "FILE|DIR")]
        output: Option<PathBuf>,
    },
}

/// Runs it.
pub fn run(arguments: Arguments, json: bool) -> Result<ExitCode, Failure> {
    match arguments.action {
        Action::Info { recording } => {
            let info = mcap::info(&recording).map_err(Failure::refused)?;
            if json {
                print_json(&info)?;
            } else {
                print!("{info}");
            }
        }
        Action::Repair { recording, output } => {
            let report = mcap::repair(&recording, output.as_deref()).map_err(Failure::refused)?;
            if json {
                print_json(&report)?;
            } else {
                print!("{report}");
            }
        }
    }
    Ok(ExitCode::SUCCESS)
}
