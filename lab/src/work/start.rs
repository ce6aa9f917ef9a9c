//! Writes the first experiment file on a recording.

use std::{fs, path::Path};

use ferntast_identification::{Inertia, JointType};
use serde::Deserialize;
use toml_edit::{Array, DocumentMut, InlineTable, Item, Table, value};

use super::WorkError;
use crate::experiment::{self, Experiment};

/// What the first experiment on a recording is to be.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Beginning {
    /// Recordings to fit, relative to the new file's folder.
    pub recordings: Vec<String>,
    /// Recordings that are never fitted.
    #[serde(default)]
    pub held_out: Vec<String>,
    /// Kind of joint.
    #[serde(default)]
    pub joint: JointType,
    /// Signals by name: position, motor_torque, and what else there is of
    /// joint_torque, temperature, valid, time; of a contact position, tangential_force,
    /// normal_force; anything else is an extra signal.
    pub signals: std::collections::BTreeMap<String, String>,
    /// J; a contact has none.
    pub inertia: Inertia,
    /// Motor turns in one turn of the joint \[1\].
    #[serde(default)]
    pub gear_ratio: Option<f64>,
    /// Ids of effects of the catalogue.
    pub effects: Vec<String>,
}

/// Signals that are not extra ones.
const NAMED: [&str; 8] = [
    "position",
    "motor_torque",
    "tangential_force",
    "normal_force",
    "joint_torque",
    "temperature",
    "valid",
    "time",
];

/// Writes the experiment file to `output` and reads it back.
///
/// # Errors
///
/// The file exists; it cannot be written; what it says cannot be used (then it
/// is not written).
pub fn start(beginning: &Beginning, output: &Path) -> Result<Experiment, WorkError> {
    if output.exists() {
        return Err(WorkError::Exists {
            path: output.to_owned(),
        });
    }
    let text = document(beginning).to_string();
    let experiment = Experiment::parse(&text, output, &experiment::data_folder())?;
    fs::write(output, text).map_err(|source| WorkError::File {
        path: output.to_owned(),
        source,
    })?;
    Ok(experiment)
}

fn document(beginning: &Beginning) -> DocumentMut {
    let mut document = DocumentMut::new();
    let list = |paths: &[String]| value(Array::from_iter(paths.iter().map(String::as_str)));
    document.insert("recording", list(&beginning.recordings));
    if !beginning.held_out.is_empty() {
        document.insert("held_out", list(&beginning.held_out));
    }
    let mut joint = Table::new();
    let kind = match beginning.joint {
        JointType::Revolute => Some("revolute"),
        JointType::Prismatic => Some("prismatic"),
        JointType::Contact => None,
    };
    match kind {
        Some(kind) => {
            joint.insert("type", value(kind));
            document.insert("joint", Item::Table(joint));
        }
        None => {
            document.insert("contact", Item::Table(joint));
        }
    }
    let mut signals = Table::new();
    let mut extra = Table::new();
    let given = beginning
        .signals
        .iter()
        .filter(|(_, path)| !path.is_empty());
    for (name, path) in given {
        let table = match NAMED.contains(&name.as_str()) {
            true => &mut signals,
            false => &mut extra,
        };
        table.insert(name, value(path.as_str()));
    }
    if !extra.is_empty() {
        signals.insert("extra", Item::Table(extra));
    }
    document.insert("signals", Item::Table(signals));
    let mut model = Table::new();
    if !beginning.joint.is_contact() {
        model.insert("inertia", inertia(beginning.inertia));
    }
    if let Some(ratio) = beginning.gear_ratio {
        model.insert("gear_ratio", value(ratio));
    }
    model.insert("effects", list(&beginning.effects));
    document.insert("model", Item::Table(model));
    document
}

fn inertia(inertia: Inertia) -> Item {
    match inertia {
        Inertia::Given(inertia) => value(inertia),
        Inertia::Fit => {
            let mut fit = InlineTable::new();
            fit.insert("fit", true.into());
            value(fit)
        }
    }
}
