//! `ferntast lab auto`.

use std::{path::PathBuf, process::ExitCode};

use ferntast_lab::work::{self, AutoEvent, AutoOptions};
use ferntast_nodes::process::stop_on_signals;
use ferntast_studies::{
    lab_folder::{self, Completed, LabFolder},
    shard::Placed,
};
use indicatif::ProgressBar;

use super::{
    super::{Failure, output::print_json, shard_options::ShardOptions},
    arm, open, table,
};

/// Diagnose and add until nothing more is named.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "It ends where the verdict is complete, or unexplained: what is left has no name in the catalogue. \
    --partial goes on there with effects that lower the error though they are not the explanation.\n\n\
    Of a folder every experiment file in it is completed, on all processors or in parts:\n  \
    ferntast lab auto joints/ -o completed\n  \
    ferntast lab auto joints/ -o completed --shard 2/8     # then: ferntast merge"
)]
pub struct Arguments {
    /// Experiment file, or a folder of them.
    experiment: PathBuf,

    /// Folder for the new experiment files (else beside the old one; of a folder: `auto` in it).
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

    #[command(flatten)]
    parts: ShardOptions,
}

/// Runs it.
pub fn run(arguments: Arguments, json: bool) -> Result<ExitCode, Failure> {
    if arguments.experiment.is_dir() {
        return run_folder(arguments, json);
    }
    if arguments.parts.is_asked() {
        return Err(Failure::refused(format!(
            "--shard: {} is one experiment; give a folder of them",
            arguments.experiment.display()
        )));
    }
    let options = AutoOptions {
        folder: arguments.output,
        partial: arguments.partial,
        quick: arguments.quick,
        force: arguments.force,
    };
    if let Some(code) = arm::auto(&arguments.experiment, &options, json)? {
        return Ok(code);
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

fn run_folder(arguments: Arguments, json: bool) -> Result<ExitCode, Failure> {
    let folder = arguments.experiment;
    let experiments = lab_folder::experiments(&folder)
        .map_err(|error| Failure::refused(format!("{}: {error}", folder.display())))?;
    if experiments.is_empty() {
        return Err(Failure::refused(format!(
            "{}: no experiment file (*.toml) in it; `ferntast lab new` makes one",
            folder.display()
        )));
    }
    let study = LabFolder {
        output: arguments.output.unwrap_or_else(|| folder.join("auto")),
        experiments,
        partial: arguments.partial,
        quick: arguments.quick,
        force: arguments.force,
    };
    let stop = stop_on_signals().map_err(Failure::failed)?;
    let shard = arguments.parts.shard();
    let all = shard.part_of(study.experiments.clone()).len();
    let bar = ProgressBar::new(all as u64);
    let answers = study.run(shard, &stop, || bar.inc(1));
    bar.finish_and_clear();
    let stopped = answers.len() < all;
    if stopped {
        eprintln!("stopped: {} of {all} were not done", all - answers.len());
    }
    match arguments.parts.keep(study, answers, stopped)? {
        Some((study, answers)) => tell_folder(&study, &answers, json),
        None => Ok(ExitCode::SUCCESS),
    }
}

/// Tells what came of every experiment; the exit code is 1 where one could not be used.
pub fn tell_folder(
    study: &LabFolder,
    answers: &[Placed<Completed>],
    json: bool,
) -> Result<ExitCode, Failure> {
    if json {
        print_json(&study.total(answers).map_err(Failure::refused)?)?;
    }
    for Placed { place, value } in answers {
        let path = study.path(*place);
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        match (&value.verdict, &value.error) {
            (_, Some(error)) => eprintln!("{name}: {error}"),
            (Some(verdict), None) if !json => {
                println!("{name:<40} {verdict:<12} {}", value.added.join(", "));
            }
            _ => {}
        }
    }
    Ok(match answers.iter().any(|own| own.value.error.is_some()) {
        true => ExitCode::FAILURE,
        false => ExitCode::SUCCESS,
    })
}
