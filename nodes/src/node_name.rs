//! The nodes by name.

use std::fmt;

use serde::{Deserialize, Serialize};

/// A node that runs as a process of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "snake_case")]
#[value(rename_all = "snake_case")]
pub enum NodeName {
    /// The simulated arm; hardware takes its place by speaking the same topics.
    Arm,
    /// The 1 kHz joint servo with CRTK operating states.
    Servo,
    /// The contact-force estimator (equations 5 and 6).
    Estimator,
    /// The model of a joint held against it while it moves.
    Twin,
    /// The haptic master bridge.
    Master,
    /// The operator's end of the link.
    LinkLeader,
    /// The arm's end of the link.
    LinkFollower,
    /// Carries the topics to and from ROS 2.
    Gateway,
    /// Writes a rosbag2 directory.
    Recorder,
    /// Puts a recording back on the topics.
    Player,
    /// Serves the page.
    Console,
    /// Shows every topic to Foxglove.
    Foxglove,
}

impl NodeName {
    /// The name on the command line and in `/diagnostics`.
    pub fn as_str(self) -> &'static str {
        match self {
            NodeName::Arm => "arm",
            NodeName::Servo => "servo",
            NodeName::Estimator => "estimator",
            NodeName::Twin => "twin",
            NodeName::Master => "master",
            NodeName::LinkLeader => "link_leader",
            NodeName::LinkFollower => "link_follower",
            NodeName::Gateway => "gateway",
            NodeName::Recorder => "recorder",
            NodeName::Player => "player",
            NodeName::Console => "console",
            NodeName::Foxglove => "foxglove",
        }
    }
}

impl fmt::Display for NodeName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.as_str())
    }
}
