//! `geometry_msgs/msg/Pose`.

use serde::{Deserialize, Serialize};

use crate::RosMessage;

use super::{Point, Quaternion};

/// A position and orientation.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// Position \[m\].
    pub position: Point,
    /// Orientation.
    pub orientation: Quaternion,
}

impl RosMessage for Pose {
    const INTERFACE: &'static str = "geometry_msgs/msg/Pose";
}
