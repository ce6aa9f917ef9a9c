//! A whole arm: all joints in one run, and effects that no joint alone has.

use std::{collections::BTreeMap, sync::Arc};

use axum::{Json, extract::State, response::Response};
use ferntast_identification::{
    arm::{ArmDiagnosis, ArmEffect},
    comparison::VariesTogether,
    fit::{Parameter, Rms},
};
use ferntast_lab::{
    experiment::ArmTable,
    work::{self, OpenedArm},
};
use serde::Serialize;

use super::{At, Lab, LabError, work::in_lines};

/// An effect that an arm may have, as its file names it.
#[derive(Debug, Serialize)]
pub struct OfferedEffect {
    /// `payload`, `link_inertia@elbow`.
    effect: String,
    /// In words.
    equation: &'static str,
}

/// What an arm may have besides the effects of its joints.
pub fn offered(arm: &ArmTable) -> Vec<OfferedEffect> {
    let joints = arm.joints();
    let all = ArmEffect::all(joints.len()).into_iter();
    all.map(|own| OfferedEffect {
        effect: own.term(|at| joints.get(at)).to_string(),
        equation: own.equation(),
    })
    .collect()
}

/// The arm of an experiment file, and what to do with it.
fn with_arm<T>(
    lab: &Lab,
    at: &At,
    work: impl FnOnce(&OpenedArm) -> Result<T, LabError>,
) -> Result<T, LabError> {
    let opened = lab.open(&at.path)?;
    let arm = opened.arm.as_ref();
    work(arm.ok_or_else(|| LabError::NoArm(at.path.clone()))?)
}

/// The arm's model against its recordings.
#[derive(Serialize)]
struct Compared {
    title: String,
    /// Of torques.
    unit: &'static str,
    samples: usize,
    /// Rows of all joints.
    used: usize,
    /// Over all joints, each weighted by its noise.
    rms: Rms,
    /// From the base on.
    joints: Vec<JointError>,
    /// Parameters of the effects of the arm, by effect.
    arm: BTreeMap<String, BTreeMap<String, Parameter>>,
    /// What has to be known of signals and parameters, as sentences.
    warnings: Vec<String>,
    notes: Vec<String>,
}

/// How one joint fares.
#[derive(Serialize)]
struct JointError {
    joint: String,
    rms: Rms,
    /// Error on data held out over what is measured \[-\].
    relative_error_held_out: f64,
}

/// Holds the arm's model against its recordings.
pub async fn compare(State(lab): State<Arc<Lab>>, Json(at): Json<At>) -> Response {
    in_lines(&lab, move |lab, progress| {
        progress(0.05);
        with_arm(lab, &at, |opened| {
            progress(0.3);
            let found = opened.compare()?;
            let joints = opened.dataset.joints.iter().filter_map(|name| {
                let own = found.joints.get(name)?;
                Some(JointError {
                    joint: name.clone(),
                    rms: own.rms,
                    relative_error_held_out: own.relative_error_held_out,
                })
            });
            let together = found.varies_together.iter().map(VariesTogether::text);
            let held = found.held_possible.iter();
            let held = held.map(|effect| work::held_possible(effect));
            let misread = opened.tell_misread(&found.misread);
            Ok(Compared {
                title: opened.experiment.title.clone(),
                unit: opened.torque_unit(),
                samples: found.samples,
                used: found.used,
                rms: found.rms,
                joints: joints.collect(),
                warnings: misread.into_iter().chain(together).chain(held).collect(),
                notes: opened.notes.clone(),
                arm: found.arm,
            })
        })
    })
}

/// A diagnosis, with what its candidates are called in a file.
#[derive(Serialize)]
struct Diagnosed {
    #[serde(flatten)]
    diagnosis: ArmDiagnosis,
    /// One for each candidate.
    names: Vec<String>,
    /// Joints that are read otherwise than the model has them, in words.
    told_misread: Vec<String>,
}

/// Tells which effect is missing, in which joint or in the arm.
pub async fn diagnose(State(lab): State<Arc<Lab>>, Json(at): Json<At>) -> Response {
    in_lines(&lab, move |lab, progress| {
        with_arm(lab, &at, |opened| {
            let diagnosis = opened.diagnose(progress)?;
            let candidates = diagnosis.candidates.iter();
            Ok(Diagnosed {
                names: candidates.map(|own| own.term().to_string()).collect(),
                told_misread: opened.tell_misread(&diagnosis.misread),
                diagnosis,
            })
        })
    })
}
