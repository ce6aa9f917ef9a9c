//! `ferntast lab auto`.

use std::{path::PathBuf, process::ExitCode};

use ferntast_identification::{Diagnosis, Term, Verdict, diagnosis::NamedCandidate};
use ferntast_lab::work::{Added, beside};
use serde::Serialize;

use super::{
    super::{Failure, output::print_json},
    add::refuse_existing,
    diagnose::with_bar,
    open, table,
};

/// No joint and no contact has so many effects that these data can tell apart.
const MAX_STEPS: usize = 8;

/// Diagnose and add until nothing more is named.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "It ends where the verdict is complete, or unexplained: what is left has no name in the catalogue. \
    --partial goes on there with effects that lower the error though they are not the explanation."
)]
pub struct Arguments {
    /// Experiment file.
    experiment: PathBuf,

    /// Folder for the new experiment files (else beside the old one).
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,

    /// Also take effects that help in part, where nothing explains the rest.
    #[arg(long)]
    partial: bool,

    /// Leave out the last verdict at other cut-offs of the filter.
    #[arg(long)]
    quick: bool,

    /// Write over files that are there.
    #[arg(long)]
    force: bool,
}

#[derive(Debug, Serialize)]
struct Outcome {
    steps: Vec<Step>,
    verdict: Verdict,
    /// The last experiment file.
    experiment: PathBuf,
    /// What is left after the last step.
    last: Diagnosis,
}

/// One effect more.
#[derive(Debug, Serialize)]
struct Step {
    #[serde(flatten)]
    added: Added,
    /// Whether it only takes a part of what nothing explains.
    in_part: bool,
}

/// What is added next, and whether it only helps in part.
fn next(diagnosis: &Diagnosis, partial: bool) -> Option<(String, bool)> {
    let first = |of: &[NamedCandidate]| of.first().map(|own| own.effect.clone());
    match diagnosis.verdict {
        Verdict::Missing => Some((first(&diagnosis.candidates)?, false)),
        Verdict::Unexplained if partial => Some((first(&diagnosis.helps_in_part)?, true)),
        _ => None,
    }
}

/// Runs it.
pub fn run(arguments: &Arguments, json: bool) -> Result<ExitCode, Failure> {
    let mut path = arguments.experiment.clone();
    if let Some(folder) = &arguments.output {
        std::fs::create_dir_all(folder)
            .map_err(|error| Failure::refused(format!("{}: {error}", folder.display())))?;
    }
    let mut steps: Vec<Step> = Vec::new();
    let last = loop {
        let opened = open::open_file(&path)?;
        let quick = with_bar(&opened, true)?;
        let unit = opened.torque_unit();
        let best = next(&quick, arguments.partial);
        let Some((name, in_part)) = best.filter(|_| steps.len() < MAX_STEPS) else {
            let last = match arguments.quick {
                true => quick,
                false => with_bar(&opened, false)?,
            };
            if !json {
                table::diagnosis(&last, unit);
            }
            break last;
        };
        let effect = Term::Catalogue(name);
        let mut output = beside(&path, effect.name());
        if let (Some(folder), Some(name)) = (&arguments.output, output.file_name()) {
            output = folder.join(name);
        }
        if !arguments.force {
            refuse_existing(&output)?;
        }
        let added = opened.add(&effect, &output).map_err(Failure::refused)?;
        if !json {
            println!(
                "{:<24} {:>12} -> {} {unit} on data held out{}; {}",
                added.effect,
                table::significant(added.held_out_before),
                table::significant(added.held_out_after),
                if in_part {
                    " (helps in part, explains not all)"
                } else {
                    ""
                },
                added.experiment.display()
            );
        }
        path.clone_from(&added.experiment);
        steps.push(Step { added, in_part });
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
