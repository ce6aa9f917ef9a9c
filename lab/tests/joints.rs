//! Which joints a recording is about.

#![allow(clippy::unwrap_used)]

use std::path::Path;

use ferntast_bag::{BagOptions, BagReader, BagWriter};
use ferntast_lab::joints::recorded_joints;
use ferntast_msgs::{
    Time,
    sample::{JointNames, JointSample},
    topics::{FOLLOWER_JOINT_TEMPERATURE, FOLLOWER_MEASURED_JS},
};

const START: Time = Time::from_nanos(1_700_000_000_000_000_000);

fn joints<const N: usize>(names: [&str; N]) -> JointNames {
    JointNames::new(names).unwrap()
}

/// What a recording with these temperatures and a joint state of these joints says.
fn told(temperatures: &[&str], state: Option<JointNames>) -> Option<JointNames> {
    let folder = tempfile::tempdir().unwrap();
    let path: &Path = &folder.path().join("run");
    let mut writer = BagWriter::create(path, BagOptions::default()).unwrap();
    for joint in temperatures {
        let topic = FOLLOWER_JOINT_TEMPERATURE.of(joint).unwrap();
        writer.topic(topic).unwrap();
    }
    if let Some(joints) = state {
        let channel = writer.topic(FOLLOWER_MEASURED_JS).unwrap();
        let sample = JointSample::zero(joints, START);
        writer.write(channel, START, START, &sample).unwrap();
    }
    writer.finish().unwrap();
    recorded_joints(&BagReader::open(path).unwrap())
}

#[test]
fn the_joint_state_names_them_and_else_the_topics() {
    let arm = joints(["shoulder", "elbow", "wrist"]);
    assert_eq!(told(&["wrist", "elbow"], Some(arm)), Some(arm));
    let by_topics = Some(joints(["wrist", "elbow"]));
    assert_eq!(told(&["wrist", "elbow"], None), by_topics);
    let unnameable = Some(joints(["upper arm", "fore arm"]));
    assert_eq!(told(&["wrist", "elbow"], unnameable), by_topics);
    assert_eq!(told(&[], None), None);
    assert_eq!(told(&[], unnameable), None);
}
