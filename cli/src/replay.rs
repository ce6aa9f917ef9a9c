//! `ferntast replay`.

use std::{path::PathBuf, process::ExitCode};

use ferntast_nodes::{
    graph::Graph,
    replay::{self, ReplayError},
};
use indicatif::{ProgressBar, ProgressStyle};

use super::{Failure, output::print_json};

/// Feed a lockstep recording again through servo and estimator, and a twin if asked.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// A rosbag2 directory that `ferntast lockstep --record` made.
    recording: PathBuf,

    /// Hold the model of this experiment of the lab against a joint; compared where the
    /// recording has a twin. Give it again for another joint.
    #[arg(long, value_name = "EXPERIMENT.toml")]
    twin: Vec<PathBuf>,
}

/// Runs it; exit code 1 when the outputs differ.
pub fn run(graph: &Graph, arguments: Arguments, json: bool) -> Result<ExitCode, Failure> {
    let bar = ProgressBar::new(100);
    if let Ok(style) = ProgressStyle::with_template("{bar:30} {percent} %") {
        bar.set_style(style);
    }
    let twins = &arguments.twin;
    let result = replay::run(graph, &arguments.recording, twins, &mut |share| {
        bar.set_position((share * 100.0) as u64);
    })
    .map_err(|error| match error {
        ReplayError::Run(error) => Failure::refused(error),
        error => Failure::refused(format!("{}: {error}", arguments.recording.display())),
    })?;
    bar.finish_and_clear();
    if json {
        print_json(&result)?;
    } else if result.equal {
        println!("{} messages compared, all equal", result.compared);
    } else {
        println!(
            "{} of {} messages differ; first: {}",
            result.different,
            result.compared,
            result.first_difference.as_deref().unwrap_or("-")
        );
    }
    if !json {
        result.twins.iter().for_each(|own| println!("{own}"));
    }
    Ok(if result.equal {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    })
}
