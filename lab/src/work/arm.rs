//! Work on an experiment about a whole arm: every joint in one run.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use ferntast_identification::{
    Dataset, Inertia, RecordedSession, Term,
    arm::{
        self, ArmComparison, ArmDataset, ArmDiagnosis, ArmDiscovery, ArmParts, ArmSession, ArmSpec,
        ArmTerm, Misread, PreparedArm,
    },
    comparison::parts::Says,
    fit::Parameter,
};
use ferntast_model::rigid_body::Vector3;
use serde::Serialize;

use super::{Opened, WorkError, add::fitted, misread::tell_misread};
use crate::{
    experiment::{self, ArmTable, Experiment, NextStep, write_child},
    recording::{self, Tally},
};

/// An experiment about an arm with its recordings read.
#[derive(Clone, Debug)]
pub struct OpenedArm {
    /// The experiment.
    pub experiment: Experiment,
    /// Its data.
    pub dataset: ArmDataset,
    /// The model that is believed.
    pub spec: ArmSpec,
    /// What was noticed while reading.
    pub notes: Vec<String>,
    /// What of each recording is used.
    pub tallies: Vec<Tally>,
    /// When the first session began \[s since 1970\], where recordings carry a date.
    pub date: Option<f64>,
}

/// What one addition to an arm's model did.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AddedToArm {
    /// The effect.
    pub effect: String,
    /// Its joint; `None`: every joint, or the arm.
    pub joint: Option<String>,
    /// Error on data held out, before: of the joint, else of all, each weighted by its noise.
    pub held_out_before: f64,
    /// The same after.
    pub held_out_after: f64,
    /// The new experiment file.
    pub experiment: PathBuf,
    /// All parameters of the new model, by `parameter@joint` or `effect.parameter`.
    pub parameters: BTreeMap<String, Parameter>,
    /// Those that the data do not excite.
    pub not_excited: Vec<String>,
    /// Effects whose free fit is no body that can exist: they are at the nearest that can.
    pub held_possible: Vec<String>,
}

/// Opens an experiment file that is about an arm; `None` where the path leads to another.
///
/// # Errors
///
/// [`WorkError`]: the file, or one of its recordings, cannot be used.
pub fn open_arm(path: &Path) -> Result<Option<OpenedArm>, WorkError> {
    if path.extension().is_none_or(|end| end != "toml") {
        return Ok(None);
    }
    let experiment = Experiment::read(path, &experiment::data_folder())?;
    let arm = experiment.arm.clone();
    arm.map(|arm| OpenedArm::read(experiment, &arm)).transpose()
}

/// What is said of an effect whose free fit is no body.
#[must_use]
pub fn held_possible(effect: &str) -> String {
    format!(
        "{effect}: least squares alone finds a body that cannot exist (negative mass, or an inertia that no shape \
         has); these are the nearest parameters of one that can, with the standard errors of the free fit"
    )
}

/// What is said where joints of the file are none of the arm's.
fn standing(arm: &ArmTable) -> Option<String> {
    let others = &arm.arm.standing;
    let (are, carried, which) = match others.len() {
        0 => return None,
        1 => ("is", "it carries", "it if it"),
        _ => ("are", "they carry", "those that"),
    };
    Some(format!(
        "{} of {} {are} not among the joints of [arm]: what {carried} is taken to stand at zero; list {which} moved or \
         stood elsewhere",
        others.join(", "),
        arm.urdf.display()
    ))
}

impl OpenedArm {
    pub(super) fn read(experiment: Experiment, arm: &ArmTable) -> Result<OpenedArm, WorkError> {
        let loaded = recording::load(&experiment)?;
        let dataset = dataset(&experiment, arm, &loaded.dataset);
        let count = arm.joints().len();
        let [x, y, z] = arm.gravity;
        let spec = ArmSpec {
            chain: arm.arm.chain.clone(),
            gravity: Vector3::new(x, y, z),
            armature: match &arm.armature {
                Some(armature) => armature.iter().map(|own| Inertia::Given(*own)).collect(),
                None => vec![Inertia::Fit; count],
            },
            gear_ratio: match &arm.gear_ratio {
                Some(ratios) => ratios.iter().map(|own| Some(*own)).collect(),
                None => vec![None; count],
            },
            effects: experiment.model.effects.iter().map(ArmTerm::of).collect(),
        };
        let mut notes = loaded.notes;
        notes.extend(standing(arm));
        Ok(OpenedArm {
            experiment,
            dataset,
            spec,
            notes,
            tallies: loaded.tallies,
            date: loaded.date,
        })
    }

    /// Unit of torques; of joints that turn and joints that slide both.
    #[must_use]
    pub fn torque_unit(&self) -> &'static str {
        self.unit_of(None)
    }

    /// Unit of the torque of a joint; of none, as of an effect of the arm, that of all.
    #[must_use]
    pub fn unit_of(&self, joint: Option<&str>) -> &'static str {
        let arm = self.experiment.arm.as_ref();
        arm.map_or("Nm", |arm| arm.torque_unit(joint))
    }

    /// What is said of joints that are read otherwise than the model has them, and how to mend it.
    #[must_use]
    pub fn tell_misread(&self, misread: &[Misread]) -> Vec<String> {
        let arm = self.experiment.arm.as_ref();
        arm.map_or_else(Vec::new, |arm| tell_misread(arm, misread))
    }

    /// The model against the recordings, joint by joint.
    ///
    /// # Errors
    ///
    /// [`WorkError::Arm`]: what data or model lack.
    pub fn compare(&self) -> Result<ArmComparison, WorkError> {
        arm::compare(&self.dataset, &self.spec).map_err(|error| self.refuse(error))
    }

    /// Which effect is missing, and where. `progress` is called with the share done, 0 … 1.
    ///
    /// # Errors
    ///
    /// [`WorkError::Arm`]: what data or model lack.
    pub fn diagnose(&self, progress: &mut dyn FnMut(f64)) -> Result<ArmDiagnosis, WorkError> {
        arm::diagnose(&self.dataset, &self.spec, progress).map_err(|error| self.refuse(error))
    }

    /// The fitted model taken apart, for a program that can say some effects.
    ///
    /// # Errors
    ///
    /// [`WorkError::Arm`]: what data or model lack.
    pub fn take_apart(&self, says: Says<'_>) -> Result<ArmParts, WorkError> {
        arm::take_apart(&self.dataset, &self.spec, says).map_err(|error| self.refuse(error))
    }

    /// Formulas for the joints that no effect of the catalogue explains. `progress` is
    /// called with the share done, 0 … 1.
    ///
    /// # Errors
    ///
    /// [`WorkError::Arm`]: what data or model lack.
    pub fn discover(
        &self,
        seed: u64,
        progress: &mut dyn FnMut(f64),
    ) -> Result<ArmDiscovery, WorkError> {
        let found = arm::discover(&self.dataset, &self.spec, seed, progress);
        found.map_err(|error| self.refuse(error))
    }

    /// Adds `effect`, whose name may say of which joint (`stribeck@elbow`), fits again, and
    /// writes the new experiment to `output`.
    ///
    /// # Errors
    ///
    /// [`WorkError::Arm`], [`WorkError::Write`]; nothing is written then.
    pub fn add(&self, term: &ArmTerm, output: &Path) -> Result<AddedToArm, WorkError> {
        let addition = arm::add(&self.dataset, &self.spec, term);
        let addition = addition.map_err(|error| self.refuse(error))?;
        let step = NextStep {
            effect: Some(term.written()),
            twin_recording: None,
            held_out_before: addition.held_out_before,
            held_out_after: addition.held_out_after,
            unit: self.unit_of(addition.joint.as_deref()).to_owned(),
            parameters: fitted(&addition.parameters),
        };
        write_child(&self.experiment, &step, output)?;
        Ok(AddedToArm {
            effect: addition.effect,
            joint: addition.joint,
            held_out_before: addition.held_out_before,
            held_out_after: addition.held_out_after,
            experiment: output.to_owned(),
            parameters: addition.parameters,
            not_excited: addition.not_excited,
            held_possible: addition.held_possible,
        })
    }

    /// `effect` of joint `number`, from 0; `None`: there is no such joint.
    #[must_use]
    pub fn of_joint(&self, effect: Term, number: usize) -> Option<ArmTerm> {
        let joint = self.dataset.joints.get(number)?.clone();
        Some(ArmTerm {
            effect,
            joint: Some(joint),
        })
    }

    /// Every joint as an experiment of its own, with the torque of its links as the load.
    ///
    /// # Errors
    ///
    /// [`WorkError::Arm`]: what data or model lack.
    pub fn joints(&self) -> Result<Vec<Opened>, WorkError> {
        let prepared = PreparedArm::new(&self.dataset, &self.spec);
        let prepared = prepared.map_err(|error| self.refuse(error))?;
        let each = prepared.joints.into_iter().map(|joint| Opened {
            experiment: Experiment {
                title: joint.name,
                joint: joint.dataset.joint,
                model: joint.spec,
                ..self.experiment.clone()
            },
            dataset: joint.dataset,
            notes: self.notes.clone(),
            tallies: self.tallies.clone(),
            date: self.date,
        });
        Ok(each.collect())
    }

    pub(super) fn refuse(&self, source: arm::ArmError) -> WorkError {
        WorkError::Arm {
            title: self.experiment.title.clone(),
            source: Box::new(source),
        }
    }
}

/// Positions and torques of all joints.
fn dataset(experiment: &Experiment, arm: &ArmTable, read: &Dataset) -> ArmDataset {
    let session = |own: &RecordedSession| {
        let both = experiment.of_joints(&own.position, &own.motor_torque, &own.extra)?;
        let [position, motor_torque] = both;
        Some(ArmSession {
            name: own.name.clone(),
            start: own.start,
            into_recording: own.into_recording,
            period: own.period,
            position,
            motor_torque,
            conditions: own.conditions.clone(),
        })
    };
    ArmDataset {
        joints: arm.joints().to_vec(),
        sessions: read.sessions.iter().filter_map(session).collect(),
        held_out: read.held_out.iter().filter_map(session).collect(),
        filter: read.filter,
    }
}
