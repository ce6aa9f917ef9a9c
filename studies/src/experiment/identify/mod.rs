//! What the recording of an experiment says, through the lab.
//!
//! Standard errors are those of noise and of what is wrong with the torque sensors (and the
//! contour) all the time, as far as the arm's `[estimator.uncertainty]` states it: see
//! [`systematic`].

mod contact;
mod stiffness;
pub mod systematic;

pub use contact::{Contact, ContactCalibration};
pub use stiffness::stiffness;

use std::{collections::BTreeMap, path::Path};

use ferntast_bag::BagReader;
use ferntast_control::estimator::Uncertainty;
use ferntast_identification::{
    Dataset, Term,
    data::Inertia,
    design::Design,
    experiments::damping::{self, Average, Sample},
    fit::{Parameter, fit},
    prepare,
};
use ferntast_lab::{
    experiment::{Experiment, RECORD, data_folder},
    recording,
};
use ferntast_sim::arm::ArmConfig;
use serde::Serialize;

use super::IdentifyError;
use systematic::Source;

/// Effects of the linear model, equation (3).
pub const LINEAR: &[&str] = &["coulomb", "load_coulomb", "viscous"];
/// Effects of the cubic model, equation (4).
pub const CUBIC: &[&str] = &[
    "coulomb",
    "load_coulomb",
    "viscous",
    "quadratic_viscous",
    "cubic_viscous",
];
/// Equation (4) without load, as for the sinusoidal trajectory.
pub const CUBIC_UNLOADED: &[&str] = &["coulomb", "viscous", "quadratic_viscous", "cubic_viscous"];

/// A joint's friction as identified.
#[derive(Clone, Debug, Serialize)]
pub struct Friction {
    /// b0, b0T, b1, b2, b3 by name, as far as they are in the model.
    pub parameters: BTreeMap<String, Parameter>,
    /// Parameters that the motion does not excite.
    pub not_excited: Vec<String>,
    /// RMS of the torque left \[Nm\].
    pub rms: f64,
}

impl Friction {
    /// A parameter's value; 0 where the model has none of that name.
    pub fn value(&self, name: &str) -> f64 {
        self.parameters.get(name).map_or(0.0, |found| found.value)
    }

    /// Its standard error.
    pub fn error(&self, name: &str) -> Option<f64> {
        self.parameters.get(name).and_then(|found| found.std_error)
    }

    /// Viscous part of equation (4) at `speed` ≥ 0 \[rad/s\], in its three terms \[Nm\].
    pub fn viscous(&self, speed: f64) -> [f64; 3] {
        [
            self.value("b1") * speed,
            self.value("b2") * speed * speed,
            self.value("b3") * speed.powi(3),
        ]
    }

    /// Equation (4) at `speed` ≥ 0 \[rad/s\] under the load `torque` \[Nm\].
    pub fn torque(&self, speed: f64, torque: f64) -> f64 {
        let coulomb = self.value("b0") + self.value("b0T") * torque.abs();
        coulomb + self.viscous(speed).iter().sum::<f64>()
    }
}

/// One joint's signals in a recording.
#[derive(Clone, Debug)]
pub struct JointData {
    experiment: Experiment,
    /// From 0.
    joint: usize,
    uncertainty: Uncertainty,
    /// The signals.
    pub dataset: Dataset,
    /// Mean temperature \[degC\].
    pub temperature: Option<f64>,
}

impl JointData {
    /// Reads joint `joint` (1 or 2) out of the recording at `path`.
    ///
    /// # Errors
    ///
    /// A recording that cannot be read, or is not of ours.
    pub fn read(path: &Path, joint: usize) -> Result<JointData, IdentifyError> {
        let empty = |what| IdentifyError::Empty {
            path: path.to_owned(),
            what,
        };
        let experiments = Experiment::open(path, &data_folder())?;
        let experiment = experiments
            .into_iter()
            .nth(joint.saturating_sub(1))
            .ok_or_else(|| empty("it has no such joint"))?;
        let dataset = recording::load(&experiment)?.dataset;
        let temperatures: Vec<f64> = dataset
            .sessions
            .iter()
            .filter_map(|session| session.temperature.as_ref())
            .flatten()
            .copied()
            .collect();
        let mean = temperatures.iter().sum::<f64>() / temperatures.len().max(1) as f64;
        Ok(JointData {
            experiment,
            joint: joint.saturating_sub(1),
            // Recordings of others say nothing of it.
            uncertainty: arm_of(path)
                .map_or(Uncertainty::default(), |arm| arm.estimator.uncertainty),
            dataset,
            temperature: (!temperatures.is_empty()).then_some(mean),
        })
    }

    /// Fits friction with the `effects` named, inertia as known.
    ///
    /// # Errors
    ///
    /// Data that the model cannot be fitted to.
    pub fn friction(&self, path: &Path, effects: &[&str]) -> Result<Friction, IdentifyError> {
        let mut spec = self.experiment.model.clone();
        spec.effects = effects
            .iter()
            .map(|effect| Term::Catalogue((*effect).to_owned()))
            .collect();
        let fitted = |dataset: &Dataset| -> Result<_, IdentifyError> {
            let prepared = prepare(dataset, &spec).map_err(|source| IdentifyError::Fit {
                path: path.to_owned(),
                source,
            })?;
            let design = Design::new(&prepared);
            Ok((prepared, design))
        };
        let (prepared, design) = fitted(&self.dataset)?;
        let mut found = fit(&prepared, &design);
        for source in Source::of_joint(self.joint) {
            let Some(spoilt) = source.dataset(&self.dataset, &self.uncertainty) else {
                continue;
            };
            let (prepared, design) = fitted(&spoilt)?;
            let spoilt = fit(&prepared, &design);
            for (name, own) in &mut found.parameters {
                let other = spoilt.parameters.get(name);
                if let (Some(error), Some(other)) = (&mut own.std_error, other) {
                    *error = error.hypot(other.value - own.value);
                }
            }
        }
        Ok(Friction {
            parameters: found.parameters,
            not_excited: found.not_excited,
            rms: found.train,
        })
    }

    /// The damping torque, sample by sample.
    pub fn samples(&self) -> Vec<Sample> {
        let inertia = match self.experiment.model.inertia {
            Inertia::Given(inertia) => inertia,
            Inertia::Fit => 0.0,
        };
        damping::samples(&self.dataset, inertia)
    }
}

/// Mean damping in ranges of speed \[deg/s\].
pub fn averages(samples: &[Sample], ranges: &[[f64; 2]]) -> Vec<Option<Average>> {
    let ranges: Vec<[f64; 2]> = ranges
        .iter()
        .map(|range| range.map(f64::to_radians))
        .collect();
    damping::averages(samples, &ranges)
}

/// The arm that a recording was made with, as it was believed.
fn arm_of(path: &Path) -> Result<ArmConfig, IdentifyError> {
    let empty = |what| IdentifyError::Empty {
        path: path.to_owned(),
        what,
    };
    let bag = BagReader::open(path).map_err(|source| IdentifyError::Open {
        path: path.to_owned(),
        reason: source.to_string(),
    })?;
    bag.metadata()
        .get(RECORD)
        .and_then(|record| record.get("arm"))
        .and_then(|text| serde_json::from_str(text).ok())
        .ok_or_else(|| {
            empty(
                "it does not say which arm it was made with; record it with `ferntast experiment`",
            )
        })
}
