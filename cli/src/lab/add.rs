//! `ferntast lab add`.

use std::{path::PathBuf, process::ExitCode};

use ferntast_lab::work::{beside, own_effect, refuse_existing};

use super::{
    super::{Failure, output::print_json},
    arm, open, table,
};

/// Add an effect, refit, and write the new experiment file.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  \
    ferntast lab add E.toml stribeck -o E2.toml\n  \
    ferntast lab add E.toml 'cogging=a*sin(6*q) + b*cos(6*q)'\n  \
    ferntast lab add E.toml 'bump=a*exp(-(qd/vs)^2)' --bound vs=0.005,0.2\n  \
    ferntast lab add contact.toml 'film=c*F_N*rd'\n  \
    ferntast lab add arm.toml stribeck@elbow_joint\n  \
    ferntast lab add arm.toml payload")]
pub struct Arguments {
    /// Experiment file.
    experiment: PathBuf,

    /// Effect: an id of the catalogue (`ferntast lab effects`), or NAME=EXPRESSION over q, qd,
    /// qdd, tau, tau_m, T, t and extra signals; of a contact over r, rd, rdd, F_N, F_T, T, t.
    /// Of an arm EFFECT@JOINT, without @JOINT of every joint, or one of the arm.
    effect: String,

    /// Bounds of a parameter of the expression that is searched, not fitted.
    #[arg(
        long = "bound",
        value_name = "NAME=LOW,HIGH",
        allow_hyphen_values = true
    )]
    bounds: Vec<String>,

    /// New experiment file (else beside the old one, with the effect in its name).
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Write over a file that is there.
    #[arg(long)]
    force: bool,
}

/// Runs it.
pub fn run(arguments: &Arguments, json: bool) -> Result<ExitCode, Failure> {
    let effect = own_effect(&arguments.effect, &arguments.bounds).map_err(Failure::refused)?;
    let output = arguments
        .output
        .clone()
        .unwrap_or_else(|| beside(&arguments.experiment, effect.name()));
    if !arguments.force {
        refuse_existing(&output).map_err(Failure::refused)?;
    }
    if let Some(opened) = arm::open(&arguments.experiment)? {
        return arm::add(&opened, &effect, &output, json);
    }
    let opened = open::open_file(&arguments.experiment)?;
    let added = opened.add(&effect, &output).map_err(Failure::refused)?;
    if json {
        print_json(&added)?;
        return Ok(ExitCode::SUCCESS);
    }
    println!(
        "{}: {} {unit} before, {} {unit} after on data held out ({:+.1} %)",
        added.effect,
        table::significant(added.held_out_before),
        table::significant(added.held_out_after),
        (added.held_out_after / added.held_out_before - 1.0) * 100.0,
        unit = opened.torque_unit()
    );
    table::parameters(&added.parameters, &added.not_excited);
    table::soundness(&added.soundness);
    println!("written to {}", added.experiment.display());
    Ok(ExitCode::SUCCESS)
}
