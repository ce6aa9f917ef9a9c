//! `ferntast lab auto`.

use std::{path::PathBuf, process::ExitCode};

use ferntast_lab::work::{self, AutoEvent, AutoOptions};
use indicatif::ProgressBar;

use super::{
    super::{Failure, output::print_json},
    arm, open, table,
};

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

/// Runs it.
pub fn run(arguments: Arguments, json: bool) -> Result<ExitCode, Failure> {
    let options = AutoOptions {
        folder: arguments.output,
        partial: arguments.partial,
        quick: arguments.quick,
        force: arguments.force,
    };
    if let Some(opened) = arm::open(&arguments.experiment)? {
        return arm::auto(opened, &arguments.experiment, &options, json);
    }
    let mut bar = ProgressBar::hidden();
    let mut tell = |event: AutoEvent<'_>| match event {
        AutoEvent::Opened(opened) => {
            open::tell_notes(opened);
            bar = open::bar("diagnose");
        }
        AutoEvent::Share(share) => bar.set_position((share * 1000.0) as u64),
        AutoEvent::Diagnosed(..) => bar.finish_and_clear(),
        AutoEvent::Added(opened, step) if !json => println!(
            "{:<24} {:>12} -> {} {} on data held out{}; {}",
            step.added.effect,
            table::significant(step.added.held_out_before),
            table::significant(step.added.held_out_after),
            opened.torque_unit(),
            match step.in_part {
                true => " (helps in part, explains not all)",
                false => "",
            },
            step.added.experiment.display()
        ),
        AutoEvent::Added(..) => {}
    };
    let found = work::auto(&arguments.experiment, &options, &mut tell).map_err(Failure::refused)?;
    match json {
        true => print_json(&found)?,
        false => table::diagnosis(&found.last.result, found.last.unit),
    }
    Ok(ExitCode::SUCCESS)
}
