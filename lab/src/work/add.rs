//! Adds an effect and writes the new experiment.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use ferntast_identification::{
    Addition, CustomEffect, Term, add,
    arm::ArmTerm,
    fit::{Parameter, Soundness},
};
use serde::Serialize;

use super::{Opened, WorkError, units};
use crate::experiment::{FittedParameter, NextStep, write_child};

/// What one addition did.
#[derive(Clone, Debug, PartialEq, Serialize)]
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
    pub parameters: BTreeMap<String, Parameter>,
    /// Those that the data do not excite.
    pub not_excited: Vec<String>,
    /// Whether they can be told apart, and are possible.
    #[serde(flatten)]
    pub soundness: Soundness,
}

/// `E.toml` with `stribeck` added: `E+stribeck.toml`.
#[must_use]
pub fn beside(parent: &Path, effect: &str) -> PathBuf {
    let mut name = parent.file_stem().unwrap_or_default().to_owned();
    name.push("+");
    name.push(effect);
    name.push(".toml");
    parent.with_file_name(name)
}

/// The file of the next step: beside the one before, or in a folder of its own.
#[must_use]
pub fn output_of(path: &Path, effect: &str, folder: Option<&Path>) -> PathBuf {
    let output = beside(path, effect);
    match (folder, output.file_name()) {
        (Some(folder), Some(name)) => folder.join(name),
        _ => output,
    }
}

/// Refuses to write over a file that is there.
///
/// # Errors
///
/// [`WorkError::Exists`].
pub fn refuse_existing(output: &Path) -> Result<(), WorkError> {
    match output.exists() {
        true => Err(WorkError::Exists {
            path: output.to_owned(),
        }),
        false => Ok(()),
    }
}

/// An effect as people write it: an id of the catalogue, or `NAME=EXPRESSION`
/// with bounds `NAME=LOW,HIGH` of the parameters that are searched.
///
/// # Errors
///
/// [`WorkError::OwnEffect`].
pub fn own_effect(text: &str, bounds: &[String]) -> Result<Term, WorkError> {
    let Some((name, expression)) = text.split_once('=') else {
        if let Some(bound) = bounds.first() {
            return Err(WorkError::OwnEffect(format!(
                "--bound {bound} belongs to an expression: give NAME=EXPRESSION as the effect"
            )));
        }
        return Ok(Term::Catalogue(text.trim().to_owned()));
    };
    let mut searched = BTreeMap::new();
    for text in bounds {
        let parsed = text.split_once('=').and_then(|(name, range)| {
            let (low, high) = range.split_once(',')?;
            Some((
                name.trim().to_owned(),
                [low.trim().parse().ok()?, high.trim().parse().ok()?],
            ))
        });
        let Some((name, range)) = parsed else {
            return Err(WorkError::OwnEffect(format!(
                "--bound {text:?}: write NAME=LOW,HIGH, as in vs=0.005,0.2"
            )));
        };
        searched.insert(name, range);
    }
    Ok(Term::Custom(CustomEffect {
        name: name.trim().to_owned(),
        expression: expression.trim().to_owned(),
        bounds: searched,
    }))
}

/// Parameters as an experiment file keeps them.
pub(super) fn fitted(
    parameters: &BTreeMap<String, Parameter>,
) -> BTreeMap<String, FittedParameter> {
    let each = parameters.iter().map(|(name, own)| {
        let parameter = FittedParameter {
            value: own.value,
            std_error: own.std_error,
            unit: own.unit.clone(),
        };
        (name.clone(), parameter)
    });
    each.collect()
}

impl Opened {
    /// Adds `effect`, fits again, and writes the new experiment to `output`.
    ///
    /// # Errors
    ///
    /// [`WorkError::Prepare`], [`WorkError::Write`]; nothing is written then.
    pub fn add(&self, effect: &Term, output: &Path) -> Result<Added, WorkError> {
        // Of an arm the file has all joints, and the title is this one's name.
        let written = match &self.experiment.arm {
            None => effect.clone(),
            Some(_) => ArmTerm {
                effect: effect.clone(),
                joint: Some(self.experiment.title.clone()),
            }
            .written(),
        };
        let mut addition: Addition = add(&self.dataset, &self.experiment.model, effect)
            .map_err(|error| self.refuse(error))?;
        units::in_units_of(&self.experiment, &mut addition.parameters);
        units::implausible(&self.experiment, &mut addition.soundness);
        let step = NextStep {
            effect: Some(written),
            twin_recording: None,
            held_out_before: addition.held_out_before,
            held_out_after: addition.held_out_after,
            unit: self.torque_unit().to_owned(),
            parameters: fitted(&addition.parameters),
        };
        write_child(&self.experiment, &step, output)?;
        Ok(Added {
            effect: addition.effect,
            held_out_before: addition.held_out_before,
            held_out_after: addition.held_out_after,
            experiment: output.to_owned(),
            parameters: addition.parameters,
            not_excited: addition.not_excited,
            soundness: addition.soundness,
        })
    }
}
