//! What a recording says about the delay law of the link.

use std::path::Path;

use ferntast_msgs::{
    Time,
    sample::LinkStatusSample,
    topics::{self, Topic},
};

use crate::messages;

/// The laws that the link ran, in order, by the status of one of its ends.
pub fn laws(recording: &Path, topic: Topic<LinkStatusSample>) -> Vec<String> {
    let all = messages(recording, topic);
    let mut names: Vec<String> = all.iter().map(|own| own.message.law.to_string()).collect();
    names.dedup();
    names
}

/// When the leader's end began to run another law.
pub fn switches(recording: &Path) -> Vec<Time> {
    let status = messages(recording, topics::LINK_STATUS);
    let pairs = status.windows(2);
    let switched = pairs.filter(|pair| pair[0].message.law != pair[1].message.law);
    switched.map(|pair| pair[0].message.stamp).collect()
}

/// By how much the reflected force changed \[N\] with each step, and when.
pub fn force_steps(recording: &Path) -> Vec<(Time, f64)> {
    let forces = messages(recording, topics::LEADER_REFLECTED_CF);
    let pairs = forces.windows(2);
    pairs
        .map(|pair| {
            let (before, after) = (pair[0].message, pair[1].message);
            let change = before.force.iter().zip(after.force);
            let change = change.map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
            (after.stamp, change)
        })
        .collect()
}
