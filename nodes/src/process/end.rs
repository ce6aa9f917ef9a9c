//! The ends of the link.

use serde::{Deserialize, Serialize};

/// An end of the link, and what belongs there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum End {
    /// With the hand.
    Operator,
    /// With the arm.
    Arm,
}

impl End {
    /// What is armed there, as in names of topics.
    pub const fn device(self) -> &'static str {
        match self {
            End::Operator => "leader",
            End::Arm => "follower",
        }
    }
}
