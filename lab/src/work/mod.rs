//! What is done with an experiment, by the command line and by the page alike:
//! open it, hold its model against its recordings, add an effect.

mod add;
mod error;
mod paths;
mod start;
mod twin;

use std::path::Path;

use ferntast_identification::{
    Comparison, Dataset, Diagnosis, compare, comparison::compare_drawing, diagnose,
};

use crate::{
    experiment::{self, Experiment},
    recording,
};

pub use add::{Added, beside, own_effect};
pub use error::WorkError;
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
}

impl Opened {
    /// Unit of torques or forces.
    #[must_use]
    pub fn torque_unit(&self) -> &'static str {
        self.experiment.joint.force_unit()
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
        })
    }

    /// The model against the recordings.
    ///
    /// # Errors
    ///
    /// [`WorkError::Prepare`]: what data or model lack.
    pub fn compare(&self) -> Result<Comparison, WorkError> {
        compare(&self.dataset, &self.experiment.model).map_err(|error| self.refuse(error))
    }

    /// The same, with up to `most` points of each session to be drawn.
    ///
    /// # Errors
    ///
    /// [`WorkError::Prepare`]: what data or model lack.
    pub fn compare_drawing(&self, most: usize) -> Result<Comparison, WorkError> {
        compare_drawing(&self.dataset, &self.experiment.model, most)
            .map_err(|error| self.refuse(error))
    }

    /// Which effect is missing. `progress` is called with the share done, 0 … 1.
    ///
    /// # Errors
    ///
    /// [`WorkError::Prepare`]: what data or model lack.
    pub fn diagnose(&self, progress: &mut dyn FnMut(f64)) -> Result<Diagnosis, WorkError> {
        diagnose(&self.dataset, &self.experiment.model, progress)
            .map_err(|error| self.refuse(error))
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
