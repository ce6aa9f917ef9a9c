//! From what the user names to data and model.

use std::{collections::BTreeMap, path::Path};

use ferntast_lab::work::{self, InUnit};
use indicatif::{ProgressBar, ProgressStyle};

use serde::Serialize;

use super::super::{Failure, output::print_json};

pub use ferntast_lab::work::Opened;

/// Opens an experiment file, or a recording of a session: one experiment a joint.
pub fn open(path: &Path) -> Result<Vec<Opened>, Failure> {
    let opened = work::open(path).map_err(Failure::refused)?;
    opened.iter().for_each(tell_notes);
    Ok(opened)
}

/// Opens what has to be one experiment file.
pub fn open_file(path: &Path) -> Result<Opened, Failure> {
    let opened = work::open_file(path).map_err(Failure::refused)?;
    tell_notes(&opened);
    Ok(opened)
}

/// Tells on stderr what was noticed while reading.
pub fn tell_notes(opened: &Opened) {
    for note in &opened.notes {
        eprintln!("note: {note}");
    }
}

/// A bar for work whose share done is reported.
pub fn bar(label: &str) -> ProgressBar {
    let bar = ProgressBar::new(1000);
    let template = format!("{label} {{bar:30}} {{percent}} %, {{eta}} left");
    if let Ok(style) = ProgressStyle::with_template(&template) {
        bar.set_style(style);
    }
    bar
}

/// Results of every joint by its name, and where there is one only, at the top, too.
#[derive(Debug, Serialize)]
struct Results<'a, T> {
    joints: BTreeMap<&'a str, &'a InUnit<T>>,
    #[serde(flatten)]
    only: Option<&'a InUnit<T>>,
}

/// Prints results as one JSON object, by title.
pub fn print_results<T: Serialize>(results: &[(String, InUnit<T>)]) -> Result<(), Failure> {
    let each = results.iter().map(|(title, own)| (title.as_str(), own));
    print_json(&Results {
        joints: each.collect(),
        only: match results {
            [(_, only)] => Some(only),
            _ => None,
        },
    })
}
