//! `ferntast twin experiment`.

use std::{path::PathBuf, process::ExitCode};

use ferntast_lab::work::{self, WorkError};

use super::super::{Failure, output::print_json};

#[derive(Debug, clap::Args)]
#[command(
    after_help = "The new file has the model of --model, on the recording alone. Where the twin named a missing effect, \
    that effect is added and everything fitted; else its [lineage] has the parameters as the twin found them. \
    Go on with lab compare, diagnose, add, history."
)]
pub struct Arguments {
    /// Recording of a session that ran with a twin.
    #[arg(value_name = "RECORDING")]
    recording: PathBuf,

    /// The experiment that the twin was started with.
    #[arg(long, value_name = "EXPERIMENT.toml")]
    model: PathBuf,

    /// The experiment to write; must not exist yet.
    #[arg(short, long, value_name = "NEW.toml")]
    output: PathBuf,
}

/// Runs it.
pub fn run(arguments: &Arguments, json: bool) -> Result<ExitCode, Failure> {
    let done = work::from_twin(&arguments.model, &arguments.recording, &arguments.output);
    let done = done.map_err(|error| match error {
        WorkError::Prepare { .. } => Failure::failed(error),
        _ => Failure::refused(error),
    })?;
    if json {
        print_json(&done)?;
        return Ok(ExitCode::SUCCESS);
    }
    if let Some(effect) = &done.effect {
        println!("added {effect}, which the twin found missing");
    }
    let unit = &done.unit;
    println!(
        "the model as it was left {:.4} {unit}, now {:.4} {unit} on data held out",
        done.held_out_before, done.held_out_after
    );
    for (name, own) in &done.parameters {
        let error = own
            .std_error
            .map_or_else(String::new, |error| format!(" ± {error:.3}"));
        println!("{name:<8} {:>12.4}{error} {}", own.value, own.unit);
    }
    println!("written to {}", done.experiment.display());
    Ok(ExitCode::SUCCESS)
}
