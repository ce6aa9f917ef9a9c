//! `ferntast lab add`.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    process::ExitCode,
};

use ferntast_identification::{Addition, CustomEffect, Term, add};
use ferntast_lab::experiment::{AddedEffect, FittedParameter, write_child};
use serde::Serialize;

use super::{
    super::{Failure, output::print_json},
    open::{self, Opened},
    table,
};

/// Add an effect, refit, and write the new experiment file.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  \
    ferntast lab add E.toml stribeck -o E2.toml\n  \
    ferntast lab add E.toml 'cogging=a*sin(6*q) + b*cos(6*q)'\n  \
    ferntast lab add E.toml 'bump=a*exp(-(qd/vs)^2)' --bound vs=0.005,0.2")]
pub struct Arguments {
    /// Experiment file.
    experiment: PathBuf,

    /// Effect: an id of the catalogue (`ferntast lab effects`), or NAME=EXPRESSION over q, qd,
    /// qdd, tau, tau_m, T, t and extra signals.
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
}

/// What one addition did.
#[derive(Debug, Serialize)]
pub struct Added {
    /// Id or name of the effect.
    pub effect: String,
    /// Error on data held out, before.
    pub held_out_before: f64,
    /// The same after.
    pub held_out_after: f64,
    /// The new experiment file.
    pub experiment: PathBuf,
    /// All parameters of the new model.
    pub parameters: BTreeMap<String, ferntast_identification::fit::Parameter>,
    /// Those that the data do not excite.
    pub not_excited: Vec<String>,
}

/// `E.toml` with `stribeck` added: `E+stribeck.toml`.
pub fn beside(parent: &Path, effect: &str) -> PathBuf {
    let mut name = parent.file_stem().unwrap_or_default().to_owned();
    name.push("+");
    name.push(effect);
    name.push(".toml");
    parent.with_file_name(name)
}

/// Adds `effect` to what was opened and writes the new experiment to `output`.
pub fn extend(opened: &Opened, effect: &Term, output: &Path) -> Result<Added, Failure> {
    let addition: Addition = add(&opened.dataset, &opened.experiment.model, effect)
        .map_err(|error| open::refuse(opened, error))?;
    let parameters = addition
        .parameters
        .iter()
        .map(|(name, own)| {
            let parameter = FittedParameter {
                value: own.value,
                std_error: own.std_error,
                unit: own.unit.clone(),
            };
            (name.clone(), parameter)
        })
        .collect();
    let added = AddedEffect {
        effect: effect.clone(),
        held_out_before: addition.held_out_before,
        held_out_after: addition.held_out_after,
        unit: opened.torque_unit().to_owned(),
        parameters,
    };
    write_child(&opened.experiment, &added, output).map_err(Failure::refused)?;
    Ok(Added {
        effect: addition.effect,
        held_out_before: addition.held_out_before,
        held_out_after: addition.held_out_after,
        experiment: output.to_owned(),
        parameters: addition.parameters,
        not_excited: addition.not_excited,
    })
}

fn term(arguments: &Arguments) -> Result<Term, Failure> {
    let Some((name, expression)) = arguments.effect.split_once('=') else {
        if let Some(bound) = arguments.bounds.first() {
            return Err(Failure::refused(format!(
                "--bound {bound} belongs to an expression: give NAME=EXPRESSION as the effect"
            )));
        }
        return Ok(Term::Catalogue(arguments.effect.clone()));
    };
    let mut bounds = BTreeMap::new();
    for text in &arguments.bounds {
        let parsed = text.split_once('=').and_then(|(name, range)| {
            let (low, high) = range.split_once(',')?;
            Some((
                name.trim().to_owned(),
                [low.trim().parse().ok()?, high.trim().parse().ok()?],
            ))
        });
        let Some((name, range)) = parsed else {
            return Err(Failure::refused(format!(
                "--bound {text:?}: write NAME=LOW,HIGH, as in vs=0.005,0.2"
            )));
        };
        bounds.insert(name, range);
    }
    Ok(Term::Custom(CustomEffect {
        name: name.trim().to_owned(),
        expression: expression.trim().to_owned(),
        bounds,
    }))
}

/// Runs it.
pub fn run(arguments: &Arguments, json: bool) -> Result<ExitCode, Failure> {
    let effect = term(arguments)?;
    let opened = open::open_file(&arguments.experiment)?;
    let output = arguments
        .output
        .clone()
        .unwrap_or_else(|| beside(&arguments.experiment, effect.name()));
    let added = extend(&opened, &effect, &output)?;
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
    println!("written to {}", added.experiment.display());
    Ok(ExitCode::SUCCESS)
}
