//! What is done with an experiment, by the command line and by the page alike:
//! open it, hold its model against its recordings, add an effect.

mod add;
mod document;
mod error;
mod new;
mod paths;
mod sources;
mod start;
mod twin;
mod units;

use std::path::Path;

use ferntast_identification::{
    Comparison, Dataset, Diagnosis, Discovery, compare, comparison::compare_drawing, diagnose,
    discover,
};

use crate::{
    experiment::{self, Experiment},
    recording::{self, Tally},
};

pub use add::{Added, beside, own_effect};
pub use error::{NewError, WorkError};
pub use new::{Made, NewSignal, Request, Said, make};
pub use paths::{Offered, offered};
pub use start::{Beginning, start};
pub use twin::{FromTwin, from_twin};

/// An experiment with its recordings read.
#[derive(Clone, Debug, PartialEq)]
pub struct Opened {
    /// The experiment.
    pub experiment: Experiment,
    /// Its data.
    pub dataset: Dataset,
    /// What was noticed while reading.
    pub notes: Vec<String>,
    /// What of each recording is used.
    pub tallies: Vec<Tally>,
}

impl Opened {
    /// Unit of torques or forces.
    #[must_use]
    pub fn torque_unit(&self) -> &'static str {
        self.experiment.force_unit()
    }

    /// Reads the recordings of `experiment`.
    ///
    /// # Errors
    ///
    /// [`WorkError::Load`].
    pub fn read(experiment: Experiment) -> Result<Opened, WorkError> {
        let loaded = recording::load(&experiment)?;
        Ok(Opened {
            experiment,
            dataset: loaded.dataset,
            notes: loaded.notes,
            tallies: loaded.tallies,
        })
    }

    /// The model against the recordings.
    ///
    /// # Errors
    ///
    /// [`WorkError::Prepare`]: what data or model lack.
    pub fn compare(&self) -> Result<Comparison, WorkError> {
        self.compare_drawing_with(None)
    }

    /// The same, with up to `most` points of each session to be drawn.
    ///
    /// # Errors
    ///
    /// [`WorkError::Prepare`]: what data or model lack.
    pub fn compare_drawing(&self, most: usize) -> Result<Comparison, WorkError> {
        self.compare_drawing_with(Some(most))
    }

    fn compare_drawing_with(&self, most: Option<usize>) -> Result<Comparison, WorkError> {
        let model = &self.experiment.model;
        let found = match most {
            Some(most) => compare_drawing(&self.dataset, model, most),
            None => compare(&self.dataset, model),
        };
        let mut comparison = found.map_err(|error| self.refuse(error))?;
        units::in_units_of(&self.experiment, &mut comparison.parameters);
        units::maps(&self.experiment, &mut comparison.residual_maps);
        Ok(comparison)
    }

    /// Which effect is missing. `progress` is called with the share done, 0 … 1.
    ///
    /// # Errors
    ///
    /// [`WorkError::Prepare`]: what data or model lack.
    pub fn diagnose(&self, progress: &mut dyn FnMut(f64)) -> Result<Diagnosis, WorkError> {
        let found = diagnose(&self.dataset, &self.experiment.model, progress);
        let mut diagnosis = found.map_err(|error| self.refuse(error))?;
        for candidate in &mut diagnosis.candidates {
            units::in_units_of(&self.experiment, &mut candidate.parameters);
        }
        Ok(diagnosis)
    }

    /// Formulas for what no effect of the catalogue explains. `progress` is called
    /// with the share done, 0 … 1.
    ///
    /// # Errors
    ///
    /// [`WorkError::Prepare`]: what data or model lack.
    pub fn discover(
        &self,
        seed: u64,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Discovery, WorkError> {
        let found = discover(&self.dataset, &self.experiment.model, seed, progress);
        let mut discovery = found.map_err(|error| self.refuse(error))?;
        for formula in &mut discovery.formulas {
            units::in_units_of(&self.experiment, &mut formula.parameters);
            units::of_extra_signals(&self.experiment, &mut formula.parameters);
        }
        Ok(discovery)
    }

    fn refuse(&self, source: ferntast_identification::PrepareError) -> WorkError {
        WorkError::Prepare {
            title: self.experiment.title.clone(),
            source: Box::new(source),
        }
    }
}

/// Opens an experiment file, or a recording of a session: one experiment a joint.
///
/// # Errors
///
/// [`WorkError`]: the file, or one of its recordings, cannot be used.
pub fn open(path: &Path) -> Result<Vec<Opened>, WorkError> {
    let experiments = Experiment::open(path, &experiment::data_folder())?;
    experiments.into_iter().map(Opened::read).collect()
}

/// Opens what has to be one experiment file.
///
/// # Errors
///
/// [`WorkError`]: the file, or one of its recordings, cannot be used.
pub fn open_file(path: &Path) -> Result<Opened, WorkError> {
    Opened::read(Experiment::read(path, &experiment::data_folder())?)
}
