//! `ferntast lab report`.

use std::{path::PathBuf, process::ExitCode};

use ferntast_lab::report;
use serde_json::json;

use super::{
    super::{Failure, output::print_json},
    diagnose::with_bar,
    open,
};

/// Write one self-contained page: measured against model, where it fails, what is missing, the falling error.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Experiment file, or the recording of a session (then its first joint).
    experiment: PathBuf,

    /// The page.
    #[arg(short, long, default_value = "report.html", value_name = "FILE")]
    output: PathBuf,

    /// Leave out the verdicts at other cut-offs of the filter.
    #[arg(long)]
    quick: bool,
}

/// Runs it.
pub fn run(arguments: &Arguments, json: bool) -> Result<ExitCode, Failure> {
    let opened = open::open(&arguments.experiment)?;
    let Some(opened) = opened.first() else {
        return Err(Failure::refused(format!(
            "{}: no joint in it",
            arguments.experiment.display()
        )));
    };
    let comparison = opened.compare().map_err(Failure::refused)?;
    let diagnosis = with_bar(opened, arguments.quick)?;
    let report = report::assemble(opened, &comparison, &diagnosis).map_err(Failure::refused)?;
    let html = report::render(&report).map_err(Failure::failed)?;
    std::fs::write(&arguments.output, html)
        .map_err(|error| Failure::refused(format!("{}: {error}", arguments.output.display())))?;
    if json {
        print_json(&json!({"report": arguments.output, "verdict": diagnosis.verdict}))?;
    } else {
        println!("written to {}", arguments.output.display());
    }
    Ok(ExitCode::SUCCESS)
}
