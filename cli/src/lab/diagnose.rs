//! `ferntast lab diagnose`.

use std::{path::PathBuf, process::ExitCode};

use ferntast_identification::Diagnosis;

use super::{
    super::Failure,
    arm,
    open::{self, Opened},
    table,
};

/// Tell which effect is missing.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Three verdicts: missing (with the effects that explain it, best first), complete (the rest is \
    noise), unexplained (the residual depends on these signals in a way that no effect of the catalogue has)."
)]
pub struct Arguments {
    /// Experiment file, or the recording of a session.
    experiment: PathBuf,
}

/// Diagnoses with a progress bar.
pub fn with_bar(opened: &Opened) -> Result<Diagnosis, Failure> {
    let bar = open::bar("diagnose");
    let result = opened.diagnose(&mut |share| {
        bar.set_position((share * 1000.0) as u64);
    });
    bar.finish_and_clear();
    result.map_err(Failure::refused)
}

/// Runs it.
pub fn run(arguments: &Arguments, json: bool) -> Result<ExitCode, Failure> {
    if let Some(opened) = arm::open(&arguments.experiment)? {
        return arm::diagnose(&opened, json);
    }
    let mut results = Vec::new();
    for opened in open::open(&arguments.experiment)? {
        let result = with_bar(&opened)?;
        if !json {
            println!("{}", opened.experiment.title);
            table::diagnosis(&result, opened.torque_unit());
        }
        results.push(open::InUnit {
            unit: opened.torque_unit(),
            result,
        });
    }
    if json {
        open::print_results(&results)?;
    }
    Ok(ExitCode::SUCCESS)
}
