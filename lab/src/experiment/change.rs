//! Writes a mapping into an experiment file: a new one, or one that is there, of
//! which all that is not changed stays, comments too.

use std::{collections::BTreeMap, path::Path};

use ferntast_identification::{Inertia, JointType};
use serde::Serialize;
use toml_edit::{Array, DocumentMut, InlineTable, Item, Table, TableLike, Value, value};

use super::{
    ArmPart, ExperimentError, Join, Mapping, folder_of, of_each,
    write::{push_value, turn_paths},
};

/// What is replaced in a file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Change {
    /// The key, `signals.position`.
    pub key: String,
    /// What stands there; empty where nothing does.
    pub before: String,
    /// What is to stand there; empty where nothing is.
    pub after: String,
}

/// A file's text, and what in it is new.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Changed {
    /// The text.
    pub text: String,
    /// What is replaced; of a new file nothing.
    pub changes: Vec<Change>,
}

impl Mapping {
    /// The text of a new experiment file.
    #[must_use]
    pub fn document(&self) -> String {
        let mut document = DocumentMut::new();
        Editor::default().all(&mut document, self);
        document.to_string()
    }

    /// The text of the experiment file at `path`, which is `text` now, with this
    /// mapping, as a file at `output`.
    ///
    /// # Errors
    ///
    /// [`ExperimentError`]: it is no experiment file that can be mapped.
    pub fn put_into(
        &self,
        text: &str,
        path: &Path,
        output: &Path,
    ) -> Result<Changed, ExperimentError> {
        let mut document: DocumentMut =
            text.parse()
                .map_err(|error: toml_edit::TomlError| ExperimentError::Syntax {
                    path: path.to_owned(),
                    message: error.to_string(),
                })?;
        let (from, to) = (folder_of(path), folder_of(output));
        for key in ["recording", "held_out", "unloaded"] {
            if let Some(item) = document.get_mut(key) {
                turn_paths(item, &from, &to);
            }
        }
        if let Some(urdf) = document.get_mut("arm").and_then(|arm| arm.get_mut("urdf")) {
            turn_paths(urdf, &from, &to);
        }
        let lineage = document.get_mut("lineage");
        if let Some(parent) = lineage.and_then(|lineage| lineage.get_mut("parent")) {
            turn_paths(parent, &from, &to);
        }
        let present = Mapping::parse(&document.to_string(), output)?.mapping;
        let mut editor = Editor {
            present: Some(present),
            changes: Vec::new(),
        };
        editor.all(&mut document, self);
        Ok(Changed {
            text: document.to_string(),
            changes: editor.changes,
        })
    }
}

/// A part of a mapping as the file has it; nothing where it has none.
type Part = fn(&Mapping) -> Option<Value>;

#[derive(Default)]
struct Editor {
    /// What stands there; nothing in a new file.
    present: Option<Mapping>,
    changes: Vec<Change>,
}

impl Editor {
    /// Notes a change, unless there was nothing before at all.
    fn note(&mut self, key: &str, before: String, after: String) {
        if self.present.is_some() {
            self.changes.push(Change {
                key: key.to_owned(),
                before,
                after,
            });
        }
    }

    fn all(&mut self, document: &mut DocumentMut, wanted: &Mapping) {
        self.recordings(document, wanted);
        let present = self.present.clone();
        let was = |of: Part| present.as_ref().and_then(of);
        let reading: [(&str, Part); 3] = [
            ("columns", columns),
            ("rate_hz", |own| own.rate_hz.map(Value::from)),
            ("join", join),
        ];
        for (key, of) in reading {
            self.set(document.as_table_mut(), key, key, was(of), of(wanted));
        }
        self.joint(document, wanted);
        self.signals(document, wanted);
        self.model(document, wanted);
    }

    /// Puts `now` in the place of what is there, if that is something else.
    fn set(
        &mut self,
        table: &mut dyn TableLike,
        key: &str,
        name: &str,
        was: Option<Value>,
        now: Option<Value>,
    ) {
        let text = |value: &Option<Value>| value.as_ref().map_or(String::new(), plain);
        let (before, after) = (text(&was), text(&now));
        if before == after && (was.is_some() || now.is_none()) {
            return;
        }
        self.note(name, before, after);
        match now {
            None => {
                table.remove(key);
            }
            Some(now) => put(table, key, now),
        }
    }

    fn recordings(&mut self, document: &mut DocumentMut, wanted: &Mapping) {
        // What a file says of a recording beside its name stays with it.
        let mut known = BTreeMap::new();
        for key in ["recording", "held_out"] {
            if let Some(values) = document.get(key).and_then(Item::as_array) {
                let more = values.iter().filter(|value| value.as_str().is_none());
                known.extend(more.map(|value| (group(value), value.clone())));
            }
        }
        let present = self.present.clone();
        let lists = [
            (
                "recording",
                present.as_ref().map(|own| &own.recordings),
                &wanted.recordings,
            ),
            (
                "held_out",
                present.as_ref().map(|own| &own.held_out),
                &wanted.held_out,
            ),
        ];
        for (key, was, now) in lists {
            if was == Some(now) || (was.is_none() && now.is_empty()) {
                continue;
            }
            let names = |groups: &Vec<Vec<String>>| {
                let names: Vec<String> = groups.iter().map(|files| files.join(" + ")).collect();
                names.join(", ")
            };
            self.note(key, was.map_or(String::new(), names), names(now));
            // What is only longer keeps its lines and comments.
            let longer = was.and_then(|was| now.strip_prefix(was.as_slice()));
            if let (Some(more), Some(array)) =
                (longer, document.get_mut(key).and_then(Item::as_array_mut))
            {
                for files in more {
                    let value = known.get(files).cloned();
                    push_value(array, value.unwrap_or_else(|| of_group(files)));
                }
                continue;
            }
            let new = match now.as_slice() {
                [] => {
                    document.remove(key);
                    continue;
                }
                [one] if one.len() == 1 && !known.contains_key(one) => of_group(one),
                groups => {
                    let mut array = Array::new();
                    for files in groups {
                        let value = known.get(files).cloned();
                        push_value(&mut array, value.unwrap_or_else(|| of_group(files)));
                    }
                    array.into()
                }
            };
            put(document.as_table_mut(), key, new);
        }
    }

    /// What it is about: a joint, a contact or an arm, each with a table of its own.
    fn joint(&mut self, document: &mut DocumentMut, wanted: &Mapping) {
        let present = self.present.clone();
        let word = |own: &Mapping| match (&own.arm, own.joint) {
            (Some(_), _) => "arm",
            (None, JointType::Revolute) => "revolute",
            (None, JointType::Prismatic) => "prismatic",
            (None, JointType::Contact) => "contact",
        };
        let (was, now) = (present.as_ref().map(word), word(wanted));
        let own = match now {
            "arm" | "contact" => now,
            _ => "joint",
        };
        if was != Some(now) {
            let before = was.unwrap_or_default().to_owned();
            self.note("joint.type", before, now.to_owned());
            for other in ["joint", "contact", "arm"] {
                if other != own {
                    document.remove(other);
                }
            }
            let table = document.entry(own).or_insert(Item::Table(Table::new()));
            if let Some(table) = table.as_table_like_mut()
                && own == "joint"
            {
                put(table, "type", now.into());
            }
        }
        let Some(table) = document.get_mut(own).and_then(Item::as_table_like_mut) else {
            return;
        };
        let was = |of: Part| present.as_ref().and_then(of);
        if wanted.arm.is_some() {
            let parts: [(&str, Part); 5] = [
                ("urdf", |own| Some(own.arm.as_ref()?.urdf.as_str().into())),
                ("joints", |own| {
                    let joints = own.arm.as_ref()?.joints.iter();
                    Some(Array::from_iter(joints.map(String::as_str)).into())
                }),
                ("armature", |own| numbers(own, |arm| arm.armature.as_ref())),
                ("gear_ratio", |own| {
                    numbers(own, |arm| arm.gear_ratio.as_ref())
                }),
                ("drive_gain", |own| {
                    numbers(own, |arm| arm.drive_gain.as_ref())
                }),
            ];
            for (key, of) in parts {
                // Joints that stay may be said by the links at their ends.
                let (was, now) = (was(of), of(wanted));
                if key == "joints" && was.as_ref().map(plain) != now.as_ref().map(plain) {
                    table.remove("base");
                    table.remove("tip");
                }
                self.set(table, key, &format!("arm.{key}"), was, now);
            }
        }
        if own == "contact" {
            self.set(
                table,
                "contour",
                "contact.contour",
                was(contour),
                contour(wanted),
            );
        }
    }

    fn signals(&mut self, document: &mut DocumentMut, wanted: &Mapping) {
        let present = self.present.clone();
        let table = document.entry("signals");
        let table = table.or_insert(Item::Table(Table::new()));
        let Some(table) = table.as_table_like_mut() else {
            return;
        };
        let new = of_each::keys(&wanted.signals);
        let keys: Vec<&str> = match &present {
            // A new file has them in the order in which people read them.
            None => {
                let first = [
                    "time",
                    "position",
                    "tip",
                    "motor_torque",
                    "tangential_force",
                ];
                let mut keys = new;
                keys.sort_by_key(|key| {
                    let place = first.iter().position(|own| own == key);
                    let last = usize::from(key.starts_with("extra."));
                    place.unwrap_or(first.len() + last)
                });
                keys
            }
            Some(present) => {
                let known = of_each::keys(&present.signals);
                let new = new.into_iter().filter(|key| !known.contains(key));
                known.iter().copied().chain(new).collect()
            }
        };
        for key in keys {
            let was = present.as_ref().and_then(|own| of_each::item(own, key));
            let now = of_each::item(wanted, key);
            let name = format!("signals.{key}");
            match key.strip_prefix("extra.") {
                None => self.set(table, key, &name, was, now),
                Some(key) => {
                    let mut new = Table::new();
                    // `extra.supply = …`, among the others.
                    new.set_dotted(true);
                    let extra = table.entry("extra").or_insert(Item::Table(new));
                    if let Some(extra) = extra.as_table_like_mut() {
                        self.set(extra, key, &name, was, now);
                    }
                }
            }
        }
        let extra = table.get("extra").and_then(Item::as_table_like);
        if extra.is_some_and(TableLike::is_empty) {
            table.remove("extra");
        }
    }

    fn model(&mut self, document: &mut DocumentMut, wanted: &Mapping) {
        let present = self.present.clone();
        let model = document.entry("model").or_insert(Item::Table(Table::new()));
        let Some(model) = model.as_table_like_mut() else {
            return;
        };
        let was = present.as_ref().and_then(inertia);
        self.set(model, "inertia", "model.inertia", was, inertia(wanted));
        let ratio = |own: &Mapping| own.gear_ratio.map(Value::from);
        let was = present.as_ref().and_then(ratio);
        self.set(model, "gear_ratio", "model.gear_ratio", was, ratio(wanted));
        let empty = || Item::Value(Array::new().into());
        let effects = model.entry("effects").or_insert_with(empty);
        let Some(effects) = effects.as_array_mut() else {
            return;
        };
        let was = present.map_or_else(Vec::new, |own| own.effects);
        let gone = |id: &String| !wanted.effects.contains(id);
        let new: Vec<&String> = wanted
            .effects
            .iter()
            .filter(|id| !was.contains(id))
            .collect();
        if new.is_empty() && !was.iter().any(gone) {
            return;
        }
        self.note("model.effects", was.join(", "), wanted.effects.join(", "));
        effects.retain(|value| {
            let id = value.as_str();
            id.is_none_or(|id| wanted.effects.iter().any(|own| own == id))
        });
        for id in new {
            push_value(effects, id.as_str().into());
        }
    }
}

/// A value without the spaces and comments around it.
fn plain(value: &Value) -> String {
    let mut value = value.clone();
    value.decor_mut().clear();
    value.to_string()
}

/// Puts a value where there may be one, whose comment stays.
fn put(table: &mut dyn TableLike, key: &str, mut new: Value) {
    match table.get_mut(key) {
        Some(item) => {
            if let Some(old) = item.as_value() {
                *new.decor_mut() = old.decor().clone();
            }
            *item = Item::Value(new);
        }
        None => {
            table.insert(key, value(new));
        }
    }
}

/// The files that a recording in the list is made of.
fn group(value: &Value) -> Vec<String> {
    match value {
        Value::Array(files) => {
            let names = files.iter().filter_map(Value::as_str);
            names.map(str::to_owned).collect()
        }
        Value::InlineTable(stated) => stated.get("file").map(group).unwrap_or_default(),
        one => one.as_str().map(str::to_owned).into_iter().collect(),
    }
}

fn of_group(files: &[String]) -> Value {
    match files {
        [one] => one.as_str().into(),
        several => Array::from_iter(several.iter().map(String::as_str)).into(),
    }
}

fn columns(mapping: &Mapping) -> Option<Value> {
    let names = mapping.columns.iter().map(String::as_str);
    (!mapping.columns.is_empty()).then(|| Array::from_iter(names).into())
}

fn join(mapping: &Mapping) -> Option<Value> {
    let join = match mapping.join? {
        Join::Row => "row",
        Join::Time => "time",
    };
    Some(join.into())
}

fn contour(mapping: &Mapping) -> Option<Value> {
    let corners = mapping.contour.as_ref()?.iter();
    let corners = corners.map(|corner| Value::from(Array::from_iter(*corner)));
    Some(Array::from_iter(corners).into())
}

/// A number of each joint of an arm.
fn numbers(mapping: &Mapping, of: fn(&ArmPart) -> Option<&Vec<f64>>) -> Option<Value> {
    let values = of(mapping.arm.as_ref()?)?.iter().copied();
    Some(Array::from_iter(values).into())
}

fn inertia(mapping: &Mapping) -> Option<Value> {
    if mapping.joint.is_contact() || mapping.arm.is_some() {
        return None;
    }
    Some(match mapping.inertia {
        Inertia::Given(inertia) => inertia.into(),
        Inertia::Fit => {
            let mut fit = InlineTable::new();
            fit.insert("fit", true.into());
            fit.into()
        }
    })
}
