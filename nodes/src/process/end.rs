//! The ends of the link.

use ferntast_msgs::{
    sample::OperatingStateSample,
    topics::{self, Topic},
};
use serde::{Deserialize, Serialize};

/// An end of the link, and what belongs there. Where `Option<End>` says which runs on a host, `None`
/// is both.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum End {
    /// With the hand.
    Operator,
    /// With the arm.
    Arm,
}

impl End {
    /// Whether it runs on a host that runs `here`.
    pub fn is_at(self, here: Option<End>) -> bool {
        here.is_none_or(|here| here == self)
    }

    /// What is armed there, as in names of topics.
    pub const fn device(self) -> &'static str {
        match self {
            End::Operator => "leader",
            End::Arm => "follower",
        }
    }

    /// The topic that tells the arm's state on a host that runs `here`.
    pub fn arm_state(here: Option<End>) -> Topic<OperatingStateSample> {
        match End::Arm.is_at(here) {
            true => topics::FOLLOWER_OPERATING_STATE,
            false => topics::LINK_ARM_STATE,
        }
    }
}
