//! `ferntast lab history`.

use std::{path::PathBuf, process::ExitCode};

use ferntast_lab::experiment;

use super::{
    super::{Failure, output::print_json},
    table,
};

/// Show how the error fell, step by step.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Experiment file that `lab add` wrote.
    experiment: PathBuf,
}

/// Runs it.
pub fn run(arguments: &Arguments, json: bool) -> Result<ExitCode, Failure> {
    let steps = experiment::history(&arguments.experiment, &experiment::data_folder())
        .map_err(Failure::refused)?;
    if json {
        print_json(&steps)?;
        return Ok(ExitCode::SUCCESS);
    }
    let largest = steps
        .iter()
        .filter_map(|step| step.held_out)
        .fold(f64::MIN_POSITIVE, f64::max);
    let words = steps.iter().map(|step| match &step.added {
        None => step.effects.join(", "),
        Some(added) => format!("+ {added}"),
    });
    let words: Vec<String> = words.collect();
    let width = words
        .iter()
        .map(|own| own.chars().count())
        .max()
        .unwrap_or(0);
    for (step, what) in steps.iter().zip(&words) {
        let (error, bar) = step.held_out.map_or_else(
            || ("-".to_owned(), String::new()),
            |error| {
                let length = (error / largest * 40.0).round() as usize;
                let unit = step.unit.as_deref().unwrap_or("");
                (
                    format!("{} {unit}", table::significant(error)),
                    "#".repeat(length),
                )
            },
        );
        let other = if step.other_data {
            "  (other recordings)"
        } else {
            ""
        };
        println!("{what:<width$} {error:>14} {bar}{other}");
    }
    Ok(ExitCode::SUCCESS)
}
