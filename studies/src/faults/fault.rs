//! What can go wrong: a table of faults, one variant each.

use std::fmt;

use serde::{Deserialize, Serialize};

/// A node of the control path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Node {
    /// The haptic master.
    Master,
    /// The operator's end of the link.
    LinkLeader,
    /// The arm's end of the link.
    LinkFollower,
    /// The joint servo.
    Servo,
    /// The contact-force estimator.
    Estimator,
    /// The arm's driver; the mechanics go on without it.
    Arm,
}

impl Node {
    /// Every node.
    pub const ALL: [Node; 6] = [
        Node::Master,
        Node::LinkLeader,
        Node::LinkFollower,
        Node::Servo,
        Node::Estimator,
        Node::Arm,
    ];

    /// Its name in the graph.
    pub const fn name(self) -> &'static str {
        match self {
            Node::Master => "master",
            Node::LinkLeader => "link_leader",
            Node::LinkFollower => "link_follower",
            Node::Servo => "servo",
            Node::Estimator => "estimator",
            Node::Arm => "arm",
        }
    }

    /// Where it runs.
    pub const fn side(self) -> Side {
        match self {
            Node::Master | Node::LinkLeader => Side::Operator,
            _ => Side::Arm,
        }
    }
}

/// A host.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// The operator's.
    Operator,
    /// The arm's.
    Arm,
}

/// A direction of the link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Way {
    /// From the operator to the arm.
    Forth,
    /// From the arm to the operator.
    Back,
}

/// Whom a word is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Device {
    /// The master.
    Leader,
    /// The arm.
    Follower,
    /// Both, as the page says it.
    Both,
}

/// A word of the operator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Word {
    /// Drives on.
    Enable,
    /// Drives off; the page's stop.
    Disable,
    /// Hold.
    Pause,
    /// Re-arm.
    Resume,
    /// The hand moves, the arm stays. Of schedules in files: none is drawn.
    Clutch,
    /// The hand leads the arm again.
    Engage,
}

/// What is wrong with a message of a peer on ROS 2.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Garbage {
    /// Numbers that are none, codes that there are not.
    NotANumber,
    /// Infinite numbers.
    Infinite,
    /// Finite numbers that no device reaches.
    OutOfRange,
    /// A stamp of zero.
    ZeroStamp,
}

/// What is wrong with the arm's measurement.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SensorFault {
    /// The last values again and again, with new stamps.
    Stuck,
    /// A joint's position is off by so much \[rad\].
    ZeroError(f64),
    /// A joint's torque is off by so much \[Nm\].
    TorqueError(f64),
    /// Nothing is published.
    DropOut,
    /// A position that is not a number.
    NotANumber,
}

/// One thing that goes wrong.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "fault", rename_all = "snake_case", deny_unknown_fields)]
#[expect(
    missing_docs,
    reason = "fields are named as what they are; ms are milliseconds"
)]
pub enum Fault {
    /// A node dies; its supervisor starts it again.
    Crash { node: Node },
    /// A node is not run for a while.
    Stall { node: Node, ms: i64 },
    /// Nothing on a host is run for a while; its clock goes on.
    HostStall { side: Side, ms: i64 },
    /// A host's clock is elsewhere, and goes at another rate.
    Clock {
        side: Side,
        offset_ms: i64,
        drift_ppm: f64,
    },
    /// A host's clock jumps. Backwards only a new session's does, so that all of
    /// the host starts anew then.
    ClockJump { side: Side, ms: i64 },
    /// Frames are lost.
    Loss { way: Way, share: f64, ms: i64 },
    /// Frames come twice.
    Duplicate { way: Way, share: f64, ms: i64 },
    /// Frames are held back so that later ones overtake them.
    Reorder {
        way: Way,
        share: f64,
        held_ms: i64,
        ms: i64,
    },
    /// Every frame is held back by up to so much.
    Jitter { way: Way, most_ms: i64, ms: i64 },
    /// Nothing comes through.
    Blackout { way: Way, ms: i64 },
    /// A bit of a frame is flipped.
    BitFlip { way: Way, share: f64, ms: i64 },
    /// Frames of somebody who has seen those of the session.
    Forge { way: Way, count: u32 },
    /// Frames of a while ago once more.
    Replay { way: Way, ago_ms: i64, count: u32 },
    /// A second operator's host sends to the same arm.
    SecondMaster { ms: i64 },
    /// A second source of hand positions at the master.
    SecondHand { ms: i64 },
    /// What cannot be acted on, on every topic that comes in from ROS 2.
    Garbage {
        side: Side,
        garbage: Garbage,
        count: u32,
    },
    /// Valid commands of a peer on ROS 2, on every topic that could move the arm.
    Stranger { side: Side, ms: i64 },
    /// Another delay law is asked for.
    LawSwitch { law: String },
    /// The arm's measurement is wrong.
    Sensor { sensor: SensorFault, ms: i64 },
    /// A word of the operator.
    Word { device: Device, word: Word },
    /// The page's sliders of the channel.
    Channel {
        round_trip_ms: f64,
        jitter_ms: f64,
        loss: f64,
    },
    /// The recorder's disk is full.
    DiskFull { ms: i64 },
}

impl Fault {
    /// Names of all, as files have them.
    pub const NAMES: [&str; 22] = [
        "crash",
        "stall",
        "host_stall",
        "clock",
        "clock_jump",
        "loss",
        "duplicate",
        "reorder",
        "jitter",
        "blackout",
        "bit_flip",
        "forge",
        "replay",
        "second_master",
        "second_hand",
        "garbage",
        "stranger",
        "law_switch",
        "sensor",
        "word",
        "channel",
        "disk_full",
    ];

    /// Its name, as files have it.
    pub const fn name(&self) -> &'static str {
        let index = match self {
            Fault::Crash { .. } => 0,
            Fault::Stall { .. } => 1,
            Fault::HostStall { .. } => 2,
            Fault::Clock { .. } => 3,
            Fault::ClockJump { .. } => 4,
            Fault::Loss { .. } => 5,
            Fault::Duplicate { .. } => 6,
            Fault::Reorder { .. } => 7,
            Fault::Jitter { .. } => 8,
            Fault::Blackout { .. } => 9,
            Fault::BitFlip { .. } => 10,
            Fault::Forge { .. } => 11,
            Fault::Replay { .. } => 12,
            Fault::SecondMaster { .. } => 13,
            Fault::SecondHand { .. } => 14,
            Fault::Garbage { .. } => 15,
            Fault::Stranger { .. } => 16,
            Fault::LawSwitch { .. } => 17,
            Fault::Sensor { .. } => 18,
            Fault::Word { .. } => 19,
            Fault::Channel { .. } => 20,
            Fault::DiskFull { .. } => 21,
        };
        Fault::NAMES[index]
    }

    /// How long it lasts, where it does \[ms\].
    pub fn length_ms(&mut self) -> Option<&mut i64> {
        match self {
            Fault::Stall { ms, .. }
            | Fault::HostStall { ms, .. }
            | Fault::Loss { ms, .. }
            | Fault::Duplicate { ms, .. }
            | Fault::Reorder { ms, .. }
            | Fault::Jitter { ms, .. }
            | Fault::Blackout { ms, .. }
            | Fault::BitFlip { ms, .. }
            | Fault::SecondMaster { ms }
            | Fault::SecondHand { ms }
            | Fault::Stranger { ms, .. }
            | Fault::Sensor { ms, .. }
            | Fault::DiskFull { ms } => Some(ms),
            _ => None,
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // As in the file, on a line: `crash node = "servo"`.
        let value = toml::Value::try_from(self).map_err(|_| fmt::Error)?;
        write!(f, "{}", self.name())?;
        let fields = value.as_table().into_iter().flatten();
        for (key, value) in fields.filter(|(key, _)| key.as_str() != "fault") {
            write!(f, " {key} = {value}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_files() {
        let fault = Fault::SecondMaster { ms: 5 };
        assert_eq!(fault.to_string(), "second_master ms = 5");
        let text = toml::to_string(&Fault::DiskFull { ms: 1 }).unwrap();
        assert!(text.contains("fault = \"disk_full\""), "{text}");
        assert_eq!(Fault::DiskFull { ms: 1 }.name(), "disk_full");
    }
}
