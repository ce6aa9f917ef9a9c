//! `ferntast lab auto`.

use std::{path::PathBuf, process::ExitCode};

use ferntast_lab::work::{self, AutoEvent};
use indicatif::ProgressBar;

use super::{
    super::{Failure, output::print_json},
    open, table,
};

/// Diagnose and add until the model is complete, or what is left has no name.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Experiment file.
    experiment: PathBuf,

    /// Folder for the new experiment files (else beside the old one).
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// Runs it.
pub fn run(arguments: &Arguments, json: bool) -> Result<ExitCode, Failure> {
    let mut bar = ProgressBar::hidden();
    let mut tell = |event: AutoEvent<'_>| match event {
        AutoEvent::Opened(opened) => {
            open::tell_notes(opened);
            bar = open::bar("diagnose");
        }
        AutoEvent::Share(share) => bar.set_position((share * 1000.0) as u64),
        AutoEvent::Diagnosed(..) => bar.finish_and_clear(),
        AutoEvent::Added(opened, added) if !json => println!(
            "{:<24} {:>12} -> {} {} on data held out; {}",
            added.effect,
            table::significant(added.held_out_before),
            table::significant(added.held_out_after),
            opened.torque_unit(),
            added.experiment.display()
        ),
        AutoEvent::Added(..) => {}
    };
    let found = work::auto(
        &arguments.experiment,
        arguments.output.as_deref(),
        &mut tell,
    );
    let found = found.map_err(Failure::refused)?;
    if json {
        print_json(&found)?;
    } else {
        table::diagnosis(&found.last.result, found.last.unit);
    }
    Ok(ExitCode::SUCCESS)
}
