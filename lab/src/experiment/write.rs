//! Writes the experiment that comes out of another one: with an effect more, or on what its twin saw.

use std::{
    collections::BTreeMap,
    fs,
    path::{Component, Path, PathBuf},
};

use ferntast_identification::Term;
use toml_edit::{Array, DocumentMut, InlineTable, Item, Table, Value, value};

use super::{DATA_VARIABLE, Experiment, FittedParameter, WriteError, data_hash, folder_of};

/// What makes a new experiment out of its parent, and what it brought.
#[derive(Clone, Debug, PartialEq)]
pub struct NextStep {
    /// The effect that is added.
    pub effect: Option<Term>,
    /// The recording that the parent's twin was recorded in: it takes the
    /// place of the parent's recordings.
    pub twin_recording: Option<PathBuf>,
    /// Error on data not fitted, before.
    pub held_out_before: f64,
    /// Error on data not fitted, after.
    pub held_out_after: f64,
    /// Unit of both errors.
    pub unit: String,
    /// The parameters by name, those of all effects: fitted, or as the twin found them.
    pub parameters: BTreeMap<String, FittedParameter>,
}

/// Writes `parent` with that step done to `output`, with its lineage.
/// Comments and order of the parent's file stay. Relative paths are turned so
/// that they lead to the same recordings.
///
/// # Errors
///
/// [`WriteError`]; nothing is written then.
pub fn write_child(parent: &Experiment, step: &NextStep, output: &Path) -> Result<(), WriteError> {
    let Some(parent_path) = &parent.path else {
        return Err(WriteError::NoParent);
    };
    let is_parent = match (output.canonicalize(), parent_path.canonicalize()) {
        (Ok(output), Ok(parent)) => output == parent,
        _ => output == parent_path,
    };
    if is_parent {
        return Err(WriteError::OverParent {
            path: output.to_owned(),
        });
    }
    if let Some(name) = step.effect.as_ref().map(Term::name)
        && parent.model.effects.iter().any(|term| term.name() == name)
    {
        return Err(WriteError::Twice {
            effect: name.to_owned(),
        });
    }
    let again = |reason: String| WriteError::Parent {
        path: parent_path.clone(),
        reason,
    };
    let text = fs::read_to_string(parent_path).map_err(|error| again(error.to_string()))?;
    let mut document: DocumentMut = text
        .parse()
        .map_err(|error: toml_edit::TomlError| again(error.to_string()))?;
    let (from, to) = (folder_of(parent_path), folder_of(output));
    let mut recordings = parent.files();
    if let Some(recording) = &step.twin_recording {
        let path = turned(&recording.to_string_lossy(), Path::new("."), &to);
        document.insert("recording", value(path));
        document.remove("held_out");
        document.remove("unloaded");
        recordings = vec![recording.clone()];
    }
    for key in ["recording", "held_out", "unloaded"] {
        if let Some(item) = document.get_mut(key)
            && step.twin_recording.is_none()
        {
            turn_paths(item, &from, &to);
        }
    }
    if let Some(urdf) = document.get_mut("arm").and_then(|arm| arm.get_mut("urdf")) {
        turn_paths(urdf, &from, &to);
    }
    let effects = document
        .get_mut("model")
        .and_then(|model| model.get_mut("effects"))
        .and_then(Item::as_array_mut)
        .ok_or_else(|| again("model.effects is no list".to_owned()))?;
    if let Some(effect) = &step.effect {
        push(effects, effect);
    }
    let hash =
        data_hash(&recordings).map_err(|(path, source)| WriteError::Data { path, source })?;
    document.insert(
        "lineage",
        Item::Table(lineage(step, &hash, &from, &to, parent_path)),
    );
    fs::write(output, document.to_string()).map_err(|source| WriteError::Write {
        path: output.to_owned(),
        source,
    })
}

/// Puts an effect behind the others, on a line of its own where they have that.
fn push(effects: &mut Array, effect: &Term) {
    let new: Value = match effect {
        Term::Catalogue(id) => id.as_str().into(),
        Term::Custom(custom) => {
            let mut table = InlineTable::new();
            table.insert("name", custom.name.as_str().into());
            table.insert("expression", custom.expression.as_str().into());
            for (parameter, [lower, upper]) in &custom.bounds {
                table.insert(parameter, Array::from_iter([*lower, *upper]).into());
            }
            table.into()
        }
    };
    push_value(effects, new);
}

/// Puts a value behind the others, on a line of its own where they have that.
pub(super) fn push_value(array: &mut Array, mut new: Value) {
    let prefix = array
        .iter()
        .last()
        .and_then(|last| last.decor().prefix()?.as_str())
        .map(|prefix| match prefix.rsplit_once('\n') {
            Some((_, indent)) => format!(
                "\n{}",
                indent.trim_end_matches(|c: char| !c.is_whitespace())
            ),
            None if array.len() > 1 => prefix.to_owned(),
            None => " ".to_owned(),
        });
    let default = if array.is_empty() { "" } else { " " };
    new.decor_mut()
        .set_prefix(prefix.unwrap_or_else(|| default.to_owned()));
    array.push_formatted(new);
}

fn lineage(step: &NextStep, hash: &str, from: &Path, to: &Path, parent_path: &Path) -> Table {
    let mut table = Table::new();
    let parent_name = parent_path.file_name().unwrap_or_default();
    let parent = turned(&parent_name.to_string_lossy(), from, to);
    table.insert("parent", value(parent));
    if let Some(effect) = &step.effect {
        table.insert("effect", value(effect.name()));
    }
    if step.twin_recording.is_some() {
        table.insert("from_twin", value(true));
    }
    table.insert("data_sha256", value(hash));
    table.insert("held_out_before", value(step.held_out_before));
    table.insert("held_out_after", value(step.held_out_after));
    table.insert("unit", value(step.unit.as_str()));
    let mut parameters = Table::new();
    for (name, parameter) in &step.parameters {
        let mut entry = InlineTable::new();
        entry.insert("value", parameter.value.into());
        if let Some(std_error) = parameter.std_error.filter(|error| error.is_finite()) {
            entry.insert("std_error", std_error.into());
        }
        entry.insert("unit", parameter.unit.as_str().into());
        parameters.insert(name, value(entry));
    }
    table.insert("parameters", Item::Table(parameters));
    table
}

/// Turns relative paths that count from `from` into such that count from `to`.
pub(super) fn turn_paths(item: &mut Item, from: &Path, to: &Path) {
    if let Some(value) = item.as_value_mut() {
        turn_value(value, from, to);
    }
}

fn turn_value(value: &mut Value, from: &Path, to: &Path) {
    if let Value::Array(paths) = value {
        paths.iter_mut().for_each(|own| turn_value(own, from, to));
    } else if let Value::InlineTable(stated) = value {
        if let Some(file) = stated.get_mut("file") {
            turn_value(file, from, to);
        }
    } else if let Some(text) = value.as_str() {
        let new = turned(text, from, to);
        let decor = value.decor().clone();
        *value = new.into();
        *value.decor_mut() = decor;
    }
}

/// A path that counts from `from` as one that counts from `to`; an absolute one, or one
/// that begins with [`DATA_VARIABLE`], stays.
#[must_use]
pub fn turned(text: &str, from: &Path, to: &Path) -> String {
    let path = Path::new(text);
    if path.is_absolute() || text.starts_with(DATA_VARIABLE) {
        return text.to_owned();
    }
    let (Ok(from), Ok(to)) = (from.canonicalize(), to.canonicalize()) else {
        return from.join(path).display().to_string();
    };
    if from == to {
        return text.to_owned();
    }
    let target = from.join(path);
    let common = target
        .components()
        .zip(to.components())
        .take_while(|(a, b)| a == b)
        .count();
    let up = to.components().skip(common).map(|_| Component::ParentDir);
    let relative: PathBuf = up.chain(target.components().skip(common)).collect();
    relative.display().to_string()
}
