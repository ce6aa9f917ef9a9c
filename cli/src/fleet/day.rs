//! `ferntast fleet day`.

use std::{path::PathBuf, process::ExitCode};

use ferntast_fleet::days_of;

use super::super::{Failure, output::print_json_line};

#[derive(Debug, clap::Args)]
#[command(
    after_help = "One line of JSON for each day and joint: means of what /twin/parameters said where the motion told \
    something of a parameter, and of the joint's temperature. Days are UTC, by the recording's own stamps.\n\n  \
    ferntast fleet day recordings/monday --robot left >> fleet.jsonl"
)]
pub struct Arguments {
    /// Recording of a session that ran with a twin: a rosbag2 directory or an .mcap file.
    recording: PathBuf,

    /// What the robot is called.
    #[arg(long, value_name = "NAME")]
    robot: String,
}

/// Runs it.
pub fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let days = days_of(&arguments.recording, &arguments.robot).map_err(Failure::refused)?;
    for own in &days {
        print_json_line(own)?;
    }
    Ok(ExitCode::SUCCESS)
}
