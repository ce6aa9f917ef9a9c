//! Experiments as the page shows them.

use std::{collections::BTreeMap, sync::Arc};

use axum::{
    Json,
    extract::{Query, State},
};
use ferntast_identification::{Inertia, JointType, RecordedSession, Term};
use ferntast_lab::{
    experiment::{self, HistoryStep, Signals},
    work::{Formula, Opened},
};
use serde::Serialize;

use super::{
    At, Lab, LabError,
    arm::{OfferedEffect, offered},
    aside,
};

/// What a file holds: one experiment, or one a joint.
#[derive(Debug, Serialize)]
pub struct FileView {
    /// The file.
    path: String,
    /// Its joints.
    joints: Vec<JointView>,
    /// What an arm may have besides the effects of its joints; `None` where it is about none.
    arm: Option<Vec<OfferedEffect>>,
    /// How it came about, the first experiment first; empty for a recording.
    history: Vec<StepView>,
}

/// An experiment on one joint, or on a contact.
#[derive(Debug, Serialize)]
pub struct JointView {
    title: String,
    joint: JointType,
    /// Unit of torque.
    unit: &'static str,
    recordings: Vec<String>,
    held_out: Vec<String>,
    signals: BTreeMap<String, String>,
    inertia: Inertia,
    gear_ratio: Option<f64>,
    effects: Vec<Term>,
    /// The model's equation, part by part.
    equation: Vec<Formula>,
    sessions: Vec<SessionView>,
    notes: Vec<String>,
}

/// A session of a recording.
#[derive(Debug, Serialize)]
struct SessionView {
    name: String,
    samples: usize,
    /// \[s\]
    duration: f64,
    held_out: bool,
}

/// One experiment of a chain.
#[derive(Debug, Serialize)]
struct StepView {
    /// Relative to the lab's folder.
    path: String,
    #[serde(flatten)]
    step: HistoryStep,
}

/// Opens an experiment file or a recording of ferntast's own.
pub async fn open(
    State(lab): State<Arc<Lab>>,
    Query(at): Query<At>,
) -> Result<Json<FileView>, LabError> {
    aside(move || {
        let contents = lab.open(&at.path)?;
        let opened = &contents.joints;
        let history = match opened
            .first()
            .and_then(|first| first.experiment.path.as_deref())
        {
            Some(path) => experiment::history(path, &experiment::data_folder())?,
            None => Vec::new(),
        };
        Ok(FileView {
            path: at.path,
            joints: opened.iter().map(|opened| joint(&lab, opened)).collect(),
            arm: contents
                .arm
                .as_ref()
                .and_then(|arm| arm.experiment.arm.as_ref())
                .map(offered),
            history: history
                .into_iter()
                .map(|step| {
                    // A parent is found as `folder/../folder/file`, too.
                    let path = step.experiment.canonicalize();
                    let path = path.unwrap_or_else(|_| step.experiment.clone());
                    StepView {
                        path: lab.name(&path),
                        step,
                    }
                })
                .collect(),
        })
    })
    .await
}

fn joint(lab: &Lab, opened: &Opened) -> JointView {
    let experiment = &opened.experiment;
    let names = |paths: &[std::path::PathBuf]| paths.iter().map(|path| lab.name(path)).collect();
    let session = |held_out: bool| {
        move |session: &RecordedSession| SessionView {
            name: session.name.clone(),
            samples: session.len(),
            duration: session.len() as f64 * session.period,
            held_out,
        }
    };
    JointView {
        title: experiment.title.clone(),
        joint: experiment.joint,
        unit: opened.torque_unit(),
        recordings: names(&experiment.recordings),
        held_out: names(&experiment.held_out),
        signals: signals(&experiment.signals, experiment.joint),
        inertia: experiment.model.inertia,
        gear_ratio: experiment.model.gear_ratio,
        effects: experiment.model.effects.clone(),
        equation: opened.equation(),
        sessions: opened
            .dataset
            .sessions
            .iter()
            .map(session(false))
            .chain(opened.dataset.held_out.iter().map(session(true)))
            .collect(),
        notes: opened.notes.clone(),
    }
}

fn signals(signals: &Signals, joint: JointType) -> BTreeMap<String, String> {
    let named = [
        ("position", Some(&signals.position)),
        ("tip_y", signals.tip_y.as_ref()),
        (joint.signal("motor_torque"), Some(&signals.motor_torque)),
        ("normal_force", signals.normal_force.as_ref()),
        ("joint_torque", signals.joint_torque.as_ref()),
        ("temperature", signals.temperature.as_ref()),
        ("time", signals.time.as_ref()),
    ];
    let named = named
        .into_iter()
        .filter_map(|(name, path)| Some((name.to_owned(), path?.clone())));
    named.chain(signals.extra.clone()).collect()
}
