//! Signals that stand together under one key of an experiment file, as a mapping has
//! them one by one: `position@elbow` of an arm's joints, `tip[0]` and `tip[1]` of a contact.

use std::collections::BTreeMap;

use toml_edit::{Array, InlineTable, Value};

use super::{Mapping, Place};
use crate::unit::Unit;

/// Keys of the tip's coordinates.
pub(super) const TIP: [&str; 2] = ["tip[0]", "tip[1]"];

/// The key in the file of the signal that a mapping has as `key`.
pub(super) fn key_in_file(key: &str) -> &str {
    key.split(['@', '[']).next().unwrap_or(key)
}

/// What stands in the file under `key`; nothing where a signal of it is not there.
pub(super) fn item(mapping: &Mapping, key: &str) -> Option<Value> {
    let places = |keys: &mut dyn Iterator<Item = String>| -> Option<Vec<&Place>> {
        keys.map(|key| mapping.signals.get(&key)).collect()
    };
    match (&mapping.arm, key) {
        (Some(arm), "position" | "motor_torque") => {
            let mut keys = arm.joints.iter().map(|joint| format!("{key}@{joint}"));
            Some(of_joints(&arm.joints, &places(&mut keys)?))
        }
        (_, "tip") => {
            let each = places(&mut TIP.iter().map(|key| (*key).to_owned()))?;
            Some(Array::from_iter(each.into_iter().map(source)).into())
        }
        (_, key) => mapping.signals.get(key).map(source),
    }
}

/// One path or name for all joints where there is one, else a list.
fn of_joints(joints: &[String], places: &[&Place]) -> Value {
    let unit = places.first().and_then(|own| own.unit.clone());
    let alike = places.iter().all(|own| own.unit == unit);
    match common(joints, places).filter(|_| alike) {
        Some(column) => source(&Place {
            column,
            unit,
            time: None,
        }),
        None => Array::from_iter(places.iter().map(|own| source(own))).into(),
    }
}

/// The array by joint name, or the name with `{joint}` in it, that all of these are.
fn common(joints: &[String], places: &[&Place]) -> Option<String> {
    let first = (joints.first()?, &places.first()?.column);
    let by_name = |joint: &String| format!("[:]{{name=={joint:?}}}");
    let all = |pattern: &str, place: &dyn Fn(&String) -> String| {
        let mut each = joints.iter().zip(places);
        each.all(|(joint, own)| pattern.replace("{joint}", &place(joint)) == own.column)
    };
    let array = first.1.replace(&by_name(first.0), "{joint}");
    if first.1.starts_with('/') && array != *first.1 && all(&array, &by_name) {
        return Some(array.replace("{joint}", ""));
    }
    // Two joints at least tell what of a name is the joint's.
    let pattern = first.1.replace(first.0.as_str(), "{joint}");
    let found = joints.len() > 1 && pattern.contains("{joint}") && all(&pattern, &String::clone);
    found.then_some(pattern)
}

/// A column, with its unit where there is one.
pub(super) fn source(place: &Place) -> Value {
    let Place { column, unit, time } = place;
    if unit.is_none() && time.is_none() {
        return column.as_str().into();
    }
    let mut table = InlineTable::new();
    let key = if column.starts_with('/') {
        "path"
    } else {
        "column"
    };
    table.insert(key, column.as_str().into());
    if let Some(text) = unit {
        // One that is not known is refused where the file is read.
        let name = Unit::parse(text).map_or(text.as_str(), |unit| unit.name());
        table.insert("unit", name.into());
    }
    if let Some(time) = time {
        table.insert("time", time.as_str().into());
    }
    table.into()
}

/// Keys in the file of all signals of a mapping, each once, in their order.
pub(super) fn keys(signals: &BTreeMap<String, Place>) -> Vec<&str> {
    let mut keys: Vec<&str> = Vec::new();
    for key in signals.keys().map(|key| key_in_file(key)) {
        if !keys.contains(&key) {
            keys.push(key);
        }
    }
    keys
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(joints: [&str; 2], columns: [&str; 2], units: [Option<&str>; 2]) -> String {
        let joints = joints.map(str::to_owned);
        let mut places = columns.iter().zip(units).map(|(column, unit)| Place {
            column: (*column).to_owned(),
            unit: unit.map(str::to_owned),
            time: None,
        });
        let places = [(); 2].map(|()| places.next().unwrap());
        of_joints(&joints, &[&places[0], &places[1]]).to_string()
    }

    #[test]
    fn joints_are_written_by_one_name_where_there_is_one() {
        let arm = ["shoulder", "elbow"];
        let none = [None, None];
        let paths = arm.map(|own| format!("/js.effort[:]{{name==\"{own}\"}}.@negative"));
        for (columns, units, text) in [
            (["q_shoulder", "q_elbow"], none, "\"q_{joint}\""),
            (["q1", "q2"], none, "[\"q1\", \"q2\"]"),
            (["q_shoulder", "elbow"], none, "[\"q_shoulder\", \"elbow\"]"),
            (
                [paths[0].as_str(), paths[1].as_str()],
                none,
                "\"/js.effort.@negative\"",
            ),
            (
                ["q_shoulder", "q_elbow"],
                [Some("deg"); 2],
                "{ column = \"q_{joint}\", unit = \"deg\" }",
            ),
            (
                ["q_shoulder", "q_elbow"],
                [Some("deg"), None],
                "[{ column = \"q_shoulder\", unit = \"deg\" }, \"q_elbow\"]",
            ),
        ] {
            assert_eq!(written(arm, columns, units), text);
        }
    }
}
