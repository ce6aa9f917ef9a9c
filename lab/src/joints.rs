//! Which joints a recording is about.

use ferntast_bag::BagReader;
use ferntast_msgs::{
    sample::{JointNames, JointSample},
    topics::{FOLLOWER_JOINT_TEMPERATURE, FOLLOWER_MEASURED_JS},
};

/// The joints of the arm that was recorded: those of its first joint state
/// or, without one, those that have a temperature; `None` where it says nothing
/// of them, or has names that topics cannot have.
pub fn recorded_joints(bag: &BagReader) -> Option<JointNames> {
    of_joint_state(bag).or_else(|| of_topics(bag))
}

fn of_joint_state(bag: &BagReader) -> Option<JointNames> {
    let mut messages = bag
        .messages::<JointSample>(&FOLLOWER_MEASURED_JS.name)
        .ok()?;
    let joints = messages.next()?.ok()?.message.joints;
    let named = FOLLOWER_JOINT_TEMPERATURE.of_joints(&joints).is_ok();
    named.then_some(joints)
}

fn of_topics(bag: &BagReader) -> Option<JointNames> {
    let names: Vec<&str> = bag
        .topics()
        .filter_map(|topic| FOLLOWER_JOINT_TEMPERATURE.joint_of(&topic.name))
        .collect();
    JointNames::new(names.iter().copied()).ok()
}
