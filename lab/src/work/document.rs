//! The text of a new experiment file.

use std::path::Path;

use ferntast_identification::JointType;
use toml_edit::{Array, DocumentMut, InlineTable, Item, Table, Value, value};

use super::{
    new::{NewSignal, Request, name_from},
    sources::Sources,
};
use crate::{experiment::Join, unit::Unit};

pub(super) fn document(
    request: &Request,
    sources: &Sources,
    signals: &[NewSignal],
    joint: JointType,
    output: &Path,
) -> DocumentMut {
    let folder = match output.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    };
    let mut document = DocumentMut::new();
    let recordings = sources.recordings.iter().map(|files| {
        let names: Vec<String> = files.iter().map(|file| name_from(folder, file)).collect();
        match names.as_slice() {
            [one] => Value::from(one.as_str()),
            several => Value::Array(Array::from_iter(several.iter().map(String::as_str))),
        }
    });
    let recordings: Vec<Value> = recordings.collect();
    match recordings.as_slice() {
        [Value::String(one)] => document.insert("recording", value(one.value().as_str())),
        several => document.insert("recording", value(Array::from_iter(several.to_vec()))),
    };
    if sources.renamed {
        let names = request.columns.iter().map(String::as_str);
        document.insert("columns", value(Array::from_iter(names)));
    }
    if let Some(rate) = request.rate_hz {
        document.insert("rate_hz", value(rate));
    }
    if let Some(join) = request.join {
        let join = if join == Join::Row { "row" } else { "time" };
        document.insert("join", value(join));
    }
    let mut kind = Table::new();
    kind.insert(
        "type",
        value(match joint {
            JointType::Prismatic => "prismatic",
            _ => "revolute",
        }),
    );
    document.insert("joint", Item::Table(kind));
    let mut table = Table::new();
    for signal in signals {
        table.insert(signal.signal, source(signal));
    }
    document.insert("signals", Item::Table(table));
    let mut model = Table::new();
    let mut fit = InlineTable::new();
    fit.insert("fit", true.into());
    model.insert("inertia", value(fit));
    model.insert("effects", value(Array::from_iter(["coulomb", "viscous"])));
    document.insert("model", Item::Table(model));
    document
}

/// A column, with its unit where there is one.
fn source(signal: &NewSignal) -> Item {
    let Some(unit) = Unit::parse(&signal.unit) else {
        return value(signal.column.as_str());
    };
    let mut table = InlineTable::new();
    let key = if signal.column.starts_with('/') {
        "path"
    } else {
        "column"
    };
    table.insert(key, signal.column.as_str().into());
    table.insert("unit", unit.name().into());
    value(table)
}
