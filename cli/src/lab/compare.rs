//! `ferntast lab compare`.

use std::{path::PathBuf, process::ExitCode};

use super::{super::Failure, arm, open, table};

/// Fit the model, tell its error on data it was not fitted to, and where it fails.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "With --json always one object: the result of each joint under \"joints\", by its name; of an \
    experiment file its one result also at the top."
)]
pub struct Arguments {
    /// Experiment file, or the recording of a session.
    experiment: PathBuf,
}

/// Runs it.
pub fn run(arguments: &Arguments, json: bool) -> Result<ExitCode, Failure> {
    if let Some(opened) = arm::open(&arguments.experiment)? {
        return arm::compare(&opened, json);
    }
    let mut results = Vec::new();
    for opened in open::open(&arguments.experiment)? {
        let result = opened.compare().map_err(Failure::refused)?;
        if !json {
            println!("{}", opened.experiment.title);
            table::comparison(&result, opened.torque_unit());
        }
        let result = opened.in_unit(result);
        results.push((opened.experiment.title, result));
    }
    if json {
        open::print_results(&results)?;
    }
    Ok(ExitCode::SUCCESS)
}
