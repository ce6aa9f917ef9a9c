//! What is done with an experiment, by the command line and by the page alike:
//! open it, hold its model against its recordings, add an effect.

mod add;
mod arm;
mod arm_auto;
mod auto;
mod chain;
mod doubt;
mod equation;
mod error;
mod look;
mod misread;
mod new;
mod new_signal;
mod paths;
mod read;
mod request;
mod signals;
mod signals_of_arm;
mod signals_of_contact;
mod signals_of_joint;
mod sources;
mod start;
mod trend;
mod trial;
mod twin;
mod units;

use std::path::Path;

use ferntast_identification::{
    Comparison, Dataset, Diagnosis, Discovery, Usage, compare,
    comparison::{
        compare_drawing,
        parts::{Parts, Says, take_apart},
    },
    diagnose, diagnose_at_cutoffs, discover,
};
use serde::Serialize;

use crate::{
    experiment::{self, Experiment},
    recording::{self, Tally},
};

pub use add::{Added, beside, output_of, own_effect, refuse_existing};
pub use arm::{AddedToArm, OpenedArm, held_possible, open_arm};
pub use arm_auto::{ArmAutoEvent, AutomaticArm, auto_arm};
pub use auto::{AutoEvent, AutoOptions, Automatic, Step, auto};
pub use chain::{ArmChain, ArmJoint};
pub use doubt::Doubt;
pub use equation::Formula;
pub use error::{NewError, WorkError, in_runs};
pub use look::{Look, Question, look};
pub use misread::tell_misread;
pub use new::{Made, make};
pub use new_signal::NewSignal;
pub use paths::{Offered, offered};
pub use read::WhatIsRead;
pub use request::{OfArm, Request, Said};
pub use start::{Again, Present, Started, mapping_of, start};
pub use trend::{Point, Trend, TrendError, UnitIn, trends, trends_of_arm};
pub use trial::{Trial, trial};
pub use twin::{FromTwin, from_twin};

/// A result with the unit of its torques, as the command line and Python tell it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct InUnit<T> {
    /// Unit of torques or forces, or of what stands for them.
    pub unit: &'static str,
    /// The result.
    #[serde(flatten)]
    pub result: T,
}

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
    /// When the first session began \[s since 1970\], where recordings carry a date.
    pub date: Option<f64>,
}

impl Opened {
    /// Unit of torques or forces.
    #[must_use]
    pub fn torque_unit(&self) -> &'static str {
        self.experiment.force_unit()
    }

    /// The model's equation, part by part.
    #[must_use]
    pub fn equation(&self) -> Vec<Formula> {
        equation::of(&self.experiment)
    }

    /// `result` with the unit of its torques.
    #[must_use]
    pub fn in_unit<T>(&self, result: T) -> InUnit<T> {
        InUnit {
            unit: self.torque_unit(),
            result,
        }
    }

    /// Reads the recordings of `experiment`.
    ///
    /// # Errors
    ///
    /// [`WorkError::Load`]; [`WorkError::WholeArm`].
    pub fn read(experiment: Experiment) -> Result<Opened, WorkError> {
        if experiment.arm.is_some() {
            return Err(WorkError::WholeArm {
                title: experiment.title,
            });
        }
        let loaded = recording::load(&experiment)?;
        Ok(Opened {
            experiment,
            dataset: loaded.dataset,
            notes: loaded.notes,
            tallies: loaded.tallies,
            date: loaded.date,
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
        units::implausible(&self.experiment, &mut comparison.soundness);
        self.account(&mut comparison.used);
        Ok(comparison)
    }

    /// The fitted model taken apart, for a program that can say some effects.
    ///
    /// # Errors
    ///
    /// [`WorkError::Prepare`]: what data or model lack.
    pub fn take_apart(&self, says: Says<'_>) -> Result<Parts, WorkError> {
        take_apart(&self.dataset, &self.experiment.model, says).map_err(|error| self.refuse(error))
    }

    /// Which effect is missing. `progress` is called with the share done, 0 … 1.
    ///
    /// # Errors
    ///
    /// [`WorkError::Prepare`]: what data or model lack.
    pub fn diagnose(&self, progress: &mut dyn FnMut(f64)) -> Result<Diagnosis, WorkError> {
        let found = diagnose(&self.dataset, &self.experiment.model, progress);
        Ok(self.told(found.map_err(|error| self.refuse(error))?))
    }

    /// The same, with the verdicts at two other cut-offs of the filter.
    ///
    /// # Errors
    ///
    /// [`WorkError::Prepare`]: what data or model lack.
    pub fn diagnose_at_cutoffs(
        &self,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Diagnosis, WorkError> {
        let found = diagnose_at_cutoffs(&self.dataset, &self.experiment.model, progress);
        Ok(self.told(found.map_err(|error| self.refuse(error))?))
    }

    /// In the recordings' units, with what was left out in reading them.
    fn told(&self, mut diagnosis: Diagnosis) -> Diagnosis {
        let named = diagnosis.candidates.iter_mut();
        for candidate in named.chain(&mut diagnosis.helps_in_part) {
            units::in_units_of(&self.experiment, &mut candidate.parameters);
        }
        units::implausible(&self.experiment, &mut diagnosis.soundness);
        self.account(&mut diagnosis.used);
        diagnosis
    }

    /// Adds what was left out in reading the recordings.
    fn account(&self, used: &mut Usage) {
        for (reason, samples) in self.tallies.iter().flat_map(Tally::left_out) {
            used.add(reason, samples);
        }
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

/// Opens an experiment file, or a recording of a session: one experiment a joint, also of
/// an arm. Joints that stand still in a recording of ours are left out, with a note.
///
/// # Errors
///
/// [`WorkError`]: the file, or one of its recordings, cannot be used.
pub fn open(path: &Path) -> Result<Vec<Opened>, WorkError> {
    if let Some(arm) = open_arm(path)? {
        return arm.joints();
    }
    let experiments = Experiment::open(path, &experiment::data_folder())?;
    let mut opened = Vec::new();
    let mut still = Vec::new();
    for experiment in experiments {
        let title = experiment.title.clone();
        let of_recording = experiment.path.is_none();
        match Opened::read(experiment) {
            Err(WorkError::Load(error)) if of_recording && error.stands_still() => {
                still.push((title, error));
            }
            other => opened.push(other?),
        }
    }
    let Some(first) = opened.first_mut() else {
        let first = still.into_iter().next();
        return first.map_or(Ok(opened), |(_, error)| Err(WorkError::Load(error)));
    };
    let told = still.iter().map(|(joint, _)| {
        let path = path.display();
        format!("{joint} stands still in {path}: nothing can be learnt of it, it is left out")
    });
    first.notes.extend(told);
    Ok(opened)
}

/// Opens what has to be one experiment file.
///
/// # Errors
///
/// [`WorkError`]: the file, or one of its recordings, cannot be used.
pub fn open_file(path: &Path) -> Result<Opened, WorkError> {
    Opened::read(Experiment::read(path, &experiment::data_folder())?)
}
