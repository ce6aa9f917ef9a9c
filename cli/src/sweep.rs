//! `ferntast sweep`.

use std::{
    fs,
    path::{Path, PathBuf},
    process::ExitCode,
    time::Instant,
};

use ferntast_studies::sweep::{self, Row, SweepConfig};
use indicatif::{ProgressBar, ProgressStyle};

use super::{Failure, output::print_json};

/// Hold the delay laws against each other over delay, jitter, loss and environment.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Every trial is an operator at a task (presses and slides, taps, lets go) on the simulated arm with the servo, the\n\
    estimator and the limits of the hand's force that a session has, in virtual time, on every processor.\n\
    With -o DIR: DIR/sweep.json (every trial) and DIR/sweep.html (stability maps and curves)."
)]
pub struct Arguments {
    /// What is swept over: the shipped delay_sweep or a file.
    #[arg(value_name = "NAME|FILE", default_value = "delay_sweep")]
    file: String,

    /// Write sweep.json and sweep.html into this folder.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,

    /// Only these laws of the sweep (may be given again).
    #[arg(long, value_name = "NAME")]
    law: Vec<String>,
}

/// Runs it.
pub fn run(arguments: Arguments, json: bool) -> Result<ExitCode, Failure> {
    let mut config = SweepConfig::load(&arguments.file).map_err(Failure::refused)?;
    config.only(&arguments.law).map_err(Failure::refused)?;
    if let Some(folder) = &arguments.output {
        // Before the work, so that it is not done in vain.
        fs::create_dir_all(folder)
            .map_err(|error| Failure::refused(format!("{}: {error}", folder.display())))?;
    }
    let bar = ProgressBar::new(config.conditions().len() as u64);
    if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos}/{len} trials, {eta} left") {
        bar.set_style(style);
    }
    let begun = Instant::now();
    let rows = sweep::run(&config, || bar.inc(1)).map_err(Failure::refused)?;
    bar.finish_and_clear();
    eprintln!(
        "{} trials in {:.1} s",
        rows.len(),
        begun.elapsed().as_secs_f64()
    );
    if let Some(folder) = &arguments.output {
        let page = sweep::render(&config, &rows).map_err(Failure::failed)?;
        write(&folder.join("sweep.html"), page.as_bytes())?;
        write_rows(&folder.join("sweep.json"), &rows)?;
        eprintln!("{}", folder.join("sweep.html").display());
    }
    if json {
        print_json(&rows)?;
    } else {
        println!("{}", sweep::table(&rows));
    }
    Ok(ExitCode::SUCCESS)
}

fn write_rows(path: &Path, rows: &[Row]) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(rows).map_err(Failure::failed)?;
    write(path, text.as_bytes())
}

fn write(path: &Path, content: &[u8]) -> Result<(), Failure> {
    fs::write(path, content)
        .map_err(|error| Failure::failed(format!("{}: {error}", path.display())))
}
