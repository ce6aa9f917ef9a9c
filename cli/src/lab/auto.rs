//! `ferntast lab auto`.

use std::{path::PathBuf, process::ExitCode};

use ferntast_identification::{Diagnosis, Term, Verdict};
use ferntast_lab::work::Added;
use serde::Serialize;

use super::{
    super::{Failure, output::print_json},
    arm,
    diagnose::with_bar,
    open, table,
};

/// No joint and no contact has so many effects that these data can tell apart.
const MAX_STEPS: usize = 8;

/// Diagnose and add until the model is complete, or what is left has no name.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Experiment file.
    experiment: PathBuf,

    /// Folder for the new experiment files (else beside the old one).
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

#[derive(Debug, Serialize)]
struct Outcome {
    steps: Vec<Added>,
    verdict: Verdict,
    /// The last experiment file.
    experiment: PathBuf,
    /// What is left after the last step.
    last: Diagnosis,
}

/// Runs it.
pub fn run(arguments: &Arguments, json: bool) -> Result<ExitCode, Failure> {
    let mut path = arguments.experiment.clone();
    if let Some(folder) = &arguments.output {
        std::fs::create_dir_all(folder)
            .map_err(|error| Failure::refused(format!("{}: {error}", folder.display())))?;
    }
    if let Some(opened) = arm::open(&path)? {
        return arm::auto(opened, &path, arguments.output.as_deref(), json);
    }
    let mut steps: Vec<Added> = Vec::new();
    let last = loop {
        let opened = open::open_file(&path)?;
        let diagnosis = with_bar(&opened)?;
        let unit = opened.torque_unit();
        let best = diagnosis.candidates.first();
        let (Some(best), Verdict::Missing, true) =
            (best, diagnosis.verdict, steps.len() < MAX_STEPS)
        else {
            if !json {
                table::diagnosis(&diagnosis, unit);
            }
            break diagnosis;
        };
        let effect = Term::Catalogue(best.effect.clone());
        let output = open::output_of(&path, effect.name(), arguments.output.as_deref());
        let added = opened.add(&effect, &output).map_err(Failure::refused)?;
        if !json {
            println!(
                "{:<24} {:>12} -> {} {unit} on data held out; {}",
                added.effect,
                table::significant(added.held_out_before),
                table::significant(added.held_out_after),
                added.experiment.display()
            );
        }
        path.clone_from(&added.experiment);
        steps.push(added);
    };
    if json {
        print_json(&Outcome {
            steps,
            verdict: last.verdict,
            experiment: path,
            last,
        })?;
    }
    Ok(ExitCode::SUCCESS)
}
