//! From what the user names to data and model.

use std::path::Path;

use ferntast_identification::{Dataset, JointType};
use ferntast_lab::{
    experiment::{self, Experiment},
    recording,
};
use indicatif::{ProgressBar, ProgressStyle};

use serde::Serialize;

use super::super::{Failure, output::print_json};

/// An experiment with its recordings read.
pub struct Opened {
    /// The experiment.
    pub experiment: Experiment,
    /// Its data.
    pub dataset: Dataset,
    /// What was noticed while reading.
    pub notes: Vec<String>,
}

impl Opened {
    /// Unit of torques or forces.
    pub fn torque_unit(&self) -> &'static str {
        match self.experiment.joint {
            JointType::Revolute => "Nm",
            JointType::Prismatic => "N",
        }
    }
}

/// Opens an experiment file, or a recording of a session: one experiment a joint.
pub fn open(path: &Path) -> Result<Vec<Opened>, Failure> {
    let experiments =
        Experiment::open(path, &experiment::data_folder()).map_err(Failure::refused)?;
    experiments.into_iter().map(read).collect()
}

/// Opens what has to be one experiment file.
pub fn open_file(path: &Path) -> Result<Opened, Failure> {
    let experiment =
        Experiment::read(path, &experiment::data_folder()).map_err(Failure::refused)?;
    read(experiment)
}

fn read(experiment: Experiment) -> Result<Opened, Failure> {
    let loaded = recording::load(&experiment).map_err(Failure::refused)?;
    for note in &loaded.notes {
        eprintln!("note: {note}");
    }
    Ok(Opened {
        experiment,
        dataset: loaded.dataset,
        notes: loaded.notes,
    })
}

/// A bar for work whose share done is told.
pub fn bar(label: &str) -> ProgressBar {
    let bar = ProgressBar::new(1000);
    let template = format!("{label} {{bar:30}} {{percent}} %, {{eta}} left");
    if let Ok(style) = ProgressStyle::with_template(&template) {
        bar.set_style(style);
    }
    bar
}

/// What the data or the model lack, with the experiment's name.
pub fn refuse(opened: &Opened, error: impl std::fmt::Display) -> Failure {
    Failure::refused(format!("{}: {error}", opened.experiment.title))
}

/// Prints results as JSON: of one joint an object, of a recording of both a list.
pub fn print_results<T: Serialize>(results: &[T]) -> Result<(), Failure> {
    match results {
        [result] => print_json(result),
        results => print_json(&results),
    }
}
