//! What two hosts recorded, as the judges look at it.

use std::path::{Path, PathBuf};

use ferntast_bag::BagReader;
use ferntast_msgs::{
    Message, Time,
    sample::{Fault, HealthSample, JointSample, Level, OperatingState},
    topics::{self, Topic},
};

/// Two numbers, one of each joint, at their time.
#[derive(Clone, Copy, Debug)]
pub struct Joints {
    /// When.
    pub at: Time,
    /// Positions \[rad\].
    pub position: [f64; 2],
    /// Torques \[Nm\].
    pub effort: [f64; 2],
}

/// What was recorded, in order of time.
#[derive(Clone, Debug, Default)]
pub struct Recorded {
    /// States that the servo said.
    pub states: Vec<(Time, OperatingState)>,
    /// When tip commands count as made.
    pub commands: Vec<Time>,
    /// Where the servo wanted the joints.
    pub setpoints: Vec<Joints>,
    /// What the arm measured.
    pub measured: Vec<Joints>,
    /// What the servo had the motors do.
    pub torques: Vec<Joints>,
    /// What nodes of both hosts said that was wrong: when, and in words.
    pub told: Vec<(Time, String)>,
    /// How far the operator's clock is ahead by the arm's end of the link \[s\].
    pub clock_offsets: Vec<(Time, f64)>,
}

impl Recorded {
    /// Of the recordings `operator` and `arm`, each in parts. What the operator's
    /// host stamped is put back by `ahead` \[s\].
    pub fn read(operator: &[PathBuf], arm: &[PathBuf], ahead: f64) -> Recorded {
        let mut own = Recorded::default();
        for part in arm {
            own.add_arm(part);
        }
        for part in operator {
            own.add_told(part, ahead);
        }
        own.states.sort_by_key(|one| one.0);
        own.commands.sort();
        own.told.sort();
        for joints in [&mut own.setpoints, &mut own.measured, &mut own.torques] {
            joints.sort_by_key(|one| one.at);
        }
        own
    }

    fn add_arm(&mut self, part: &Path) {
        let states = all(part, topics::FOLLOWER_OPERATING_STATE);
        self.states
            .extend(states.map(|own| (own.message.stamp, own.message.state)));
        let commands = all(part, topics::FOLLOWER_SERVO_CP);
        self.commands.extend(commands.map(|own| own.message.stamp));
        self.setpoints
            .extend(joints(part, topics::FOLLOWER_SETPOINT_JS));
        self.measured
            .extend(joints(part, topics::FOLLOWER_MEASURED_JS));
        self.torques.extend(joints(part, topics::FOLLOWER_SERVO_JF));
        let peers = all(part, topics::LINK_FOLLOWER_PEER);
        self.clock_offsets
            .extend(peers.map(|own| (own.message.stamp, own.message.clock_offset)));
        self.add_told(part, 0.0);
    }

    fn add_told(&mut self, part: &Path, ahead: f64) {
        let health = all(part, topics::DIAGNOSTICS);
        let wrong = health.filter(|own| own.message.level >= Level::WARN);
        self.told.extend(wrong.filter_map(|own| {
            let at = own.message.stamp.plus_seconds(-ahead);
            Some((at, words(&own.message)?))
        }));
    }

    /// The state in force at `at`.
    pub fn state_at(&self, at: Time) -> Option<OperatingState> {
        let after = self.states.partition_point(|own| own.0 <= at);
        Some(self.states[..after].last()?.1)
    }

    /// When the servo became ENABLED; with each, since when it was not.
    pub fn enablings(&self) -> Vec<(Time, Time)> {
        let mut found = Vec::new();
        let mut before = OperatingState::DISABLED;
        let mut left = Time::INVALID;
        for &(at, state) in &self.states {
            let enabled = state == OperatingState::ENABLED;
            match (before == OperatingState::ENABLED, enabled) {
                (true, false) => left = at,
                (false, true) => found.push((left, at)),
                _ => {}
            }
            before = state;
        }
        found
    }
}

/// Of a node, what is wrong with it: its own words where it has some. That it was late is
/// the machine's doing.
fn words(health: &HealthSample) -> Option<String> {
    let faults = health.faults.iter();
    let faults = faults.filter(|own| *own != Fault::DeadlineMissed);
    let faults: Vec<&str> = faults.map(|own| own.name()).collect();
    match (health.message.as_str(), &faults[..]) {
        ("", []) => None,
        ("", faults) => Some(format!("{}: {}", health.node, faults.join(", "))),
        (said, _) => Some(format!("{}: {said}", health.node)),
    }
}

/// Every message of `topic` in a part; none in one that was killed before it wrote any.
fn all<M: Message>(part: &Path, topic: Topic<M>) -> impl Iterator<Item = Of<M>> {
    let reader = BagReader::open(part).unwrap_or_else(|error| panic!("{error}"));
    let messages = reader.messages::<M>(&topic.name).into_iter().flatten();
    let messages: Vec<Of<M>> = messages
        .map(|own| Of {
            message: own
                .unwrap_or_else(|error| panic!("{}: {error}", topic.name))
                .message,
        })
        .collect();
    messages.into_iter()
}

/// A message.
struct Of<M> {
    message: M,
}

fn joints(part: &Path, topic: Topic<JointSample>) -> impl Iterator<Item = Joints> {
    all(part, topic).map(|own| Joints {
        at: own.message.stamp,
        position: own.message.position(),
        effort: own.message.effort(),
    })
}

/// Those of `all` from `from` to `to`.
pub fn between(all: &[Joints], from: Time, to: Time) -> &[Joints] {
    let first = all.partition_point(|own| own.at < from);
    let last = all.partition_point(|own| own.at <= to);
    &all[first..last.max(first)]
}
