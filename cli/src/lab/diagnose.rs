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
    after_help = "Three verdicts, each on the samples that are used and no others: missing (with the effects that \
    explain it, best first), complete (no systematic rest in these samples), unexplained (the residual depends on \
    these signals in a way that no effect of the catalogue has; what helps in part is told, and is not the \
    explanation).\n\n\
    The verdict is also asked for at half and at one and a half times the cut-off of the filter; where it differs, \
    that is a warning.\n\n\
    With --json always one object: the result of each joint under \"joints\", by its name; of an experiment file its \
    one result also at the top."
)]
pub struct Arguments {
    /// Experiment file, or the recording of a session.
    experiment: PathBuf,

    /// Leave out the verdicts at other cut-offs.
    #[arg(long)]
    quick: bool,
}

/// Diagnoses with a progress bar; without the verdicts at other cut-offs if `quick`.
pub fn with_bar(opened: &Opened, quick: bool) -> Result<Diagnosis, Failure> {
    let bar = open::bar("diagnose");
    let mut progress = |share: f64| bar.set_position((share * 1000.0) as u64);
    let result = match quick {
        true => opened.diagnose(&mut progress),
        false => opened.diagnose_at_cutoffs(&mut progress),
    };
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
        let result = with_bar(&opened, arguments.quick)?;
        if !json {
            println!("{}", opened.experiment.title);
            table::diagnosis(&result, opened.torque_unit());
        }
        let result = opened.in_unit(result);
        results.push((opened.experiment.title, result));
    }
    if json {
        open::print_results(&results)?;
    }
    Ok(ExitCode::SUCCESS)
}
