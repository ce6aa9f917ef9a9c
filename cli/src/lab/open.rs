//! From what the user names to data and model.

use std::path::{Path, PathBuf};

use ferntast_lab::work;
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

fn tell_notes(opened: &Opened) {
    for note in &opened.notes {
        eprintln!("note: {note}");
    }
}

/// A result with the unit of its torques.
#[derive(Debug, Serialize)]
pub struct InUnit<T> {
    /// Unit of torques or forces, or of what stands for them.
    pub unit: &'static str,
    /// The result.
    #[serde(flatten)]
    pub result: T,
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

/// Prints results as JSON: of one joint an object, of a recording of both a list.
pub fn print_results<T: Serialize>(results: &[T]) -> Result<(), Failure> {
    match results {
        [result] => print_json(result),
        results => print_json(&results),
    }
}

/// The file of the next step: beside the one before, or in a folder of its own.
pub fn output_of(path: &Path, effect: &str, folder: Option<&Path>) -> PathBuf {
    let output = work::beside(path, effect);
    match (folder, output.file_name()) {
        (Some(folder), Some(name)) => folder.join(name),
        _ => output,
    }
}
