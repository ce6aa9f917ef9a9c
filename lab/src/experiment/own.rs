//! A recording of ferntast's own in place of an experiment file.

use std::path::Path;

use ferntast_bag::BagReader;
use ferntast_identification::{Inertia, ModelSpec, Term};
use ferntast_model::{friction, joint::JointParameters};
use ferntast_msgs::{
    sample::{JointNames, MAX_JOINTS},
    topics,
};

use super::{Experiment, ExperimentError, Signals};
use crate::{joints::recorded_joints, numbers::numbers_of};

/// Name of the metadata record that a recording of ours carries: what it was
/// made of.
pub const RECORD: &str = "ferntast";

/// One experiment a joint: the session's own topics, and the model that the
/// servo believed in.
pub(super) fn of_recording(path: &Path) -> Result<Vec<Experiment>, ExperimentError> {
    let bag = BagReader::open(path)?;
    let metadata = bag.metadata();
    let Some(record) = metadata.get(RECORD) else {
        let mut available = numbers_of(&bag);
        available.truncate(30);
        return Err(ExperimentError::NotOurs {
            path: path.to_owned(),
            available,
        });
    };
    let refuse = |reason: String| ExperimentError::Record {
        path: path.to_owned(),
        reason,
    };
    let arm = record
        .get("arm")
        .ok_or_else(|| refuse("it says nothing of the arm".to_owned()))?;
    let arm: serde_json::Value =
        serde_json::from_str(arm).map_err(|error| refuse(format!("arm: {error}")))?;
    let joints = arm.get("joint").cloned().unwrap_or_default();
    let joints: Vec<JointParameters> =
        serde_json::from_value(joints).map_err(|error| refuse(format!("arm.joint: {error}")))?;
    if joints.is_empty() {
        return Err(refuse("its arm has no joints".to_owned()));
    }
    if joints.len() > MAX_JOINTS {
        let found = joints.len();
        return Err(refuse(format!(
            "its arm has {found} joints, not 1 to {MAX_JOINTS}"
        )));
    }
    let names = recorded_joints(&bag).filter(|names| names.len() == joints.len());
    let names = names.unwrap_or_else(|| JointNames::numbered(joints.len()));
    let experiments = joints.iter().zip(names.iter()).enumerate();
    let experiments = experiments.map(|(index, (joint, name))| {
        let measured = topics::FOLLOWER_MEASURED_JS.name;
        let motor = topics::FOLLOWER_MOTOR_JS.name;
        let temperature = bag
            .topics()
            .find(|topic| topics::FOLLOWER_JOINT_TEMPERATURE.joint_of(&topic.name) == Some(name));
        let signals = Signals {
            position: format!("{measured}.position[{index}]"),
            motor_torque: format!("{motor}.effort[{index}]"),
            joint_torque: Some(format!("{measured}.effort[{index}]")),
            temperature: temperature.map(|topic| format!("{}.temperature", topic.name)),
            ..Signals::default()
        };
        let model = ModelSpec {
            inertia: Inertia::Given(joint.motor_inertia),
            gear_ratio: Some(joint.gear_ratio),
            effects: effects(joint),
        };
        Experiment::of_joint(name, path, signals, model)
    });
    Ok(experiments.collect())
}

/// The effects that the joint's friction is believed to have.
fn effects(joint: &JointParameters) -> Vec<Term> {
    let ids = friction::of_joint().map(|each| each.row.id);
    ids.filter(|id| joint.friction.effects.contains_key(*id))
        .map(|id| Term::Catalogue(id.to_owned()))
        .collect()
}
