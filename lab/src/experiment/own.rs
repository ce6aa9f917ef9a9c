//! A recording of ferntast's own in place of an experiment file.

use std::path::Path;

use ferntast_bus::mcap::BagReader;
use ferntast_identification::{Inertia, JointType, ModelSpec, Term};
use ferntast_model::{friction, joint::JointParameters};
use ferntast_msgs::topics;

use super::{Experiment, ExperimentError, Signals};
use crate::numbers::numbers_of;

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
    let temperatures = [
        topics::FOLLOWER_JOINT_1_TEMPERATURE.name,
        topics::FOLLOWER_JOINT_2_TEMPERATURE.name,
    ];
    let experiments = joints.iter().enumerate().map(|(index, joint)| {
        let measured = topics::FOLLOWER_MEASURED_JS.name;
        let motor = topics::FOLLOWER_MOTOR_JS.name;
        let temperature = temperatures
            .get(index)
            .filter(|name| bag.topics().any(|topic| topic.name == **name));
        Experiment {
            path: None,
            title: format!("joint_{}", index + 1),
            recordings: vec![path.to_owned()],
            held_out: Vec::new(),
            unloaded: Vec::new(),
            filter: None,
            joint: JointType::Revolute,
            contour: None,
            signals: Signals {
                position: format!("{measured}.position[{index}]"),
                motor_torque: format!("{motor}.effort[{index}]"),
                joint_torque: Some(format!("{measured}.effort[{index}]")),
                temperature: temperature.map(|topic| format!("{topic}.temperature")),
                ..Signals::default()
            },
            model: ModelSpec {
                inertia: Inertia::Given(joint.motor_inertia),
                gear_ratio: Some(joint.gear_ratio),
                effects: effects(joint),
            },
            lineage: None,
        }
    });
    Ok(experiments.collect())
}

/// The effects that the joint's friction is believed to have.
fn effects(joint: &JointParameters) -> Vec<Term> {
    let names = friction::EFFECTS.iter().map(|each| each.description().name);
    names
        .filter(|name| joint.friction.effects.contains_key(*name))
        .map(|name| Term::Catalogue(name.to_owned()))
        .collect()
}
