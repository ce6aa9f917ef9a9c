//! `geometry_msgs/msg/Pose`.

use serde::{Deserialize, Serialize};

use crate::message::ros_message;

use super::{Point, Quaternion};

/// A position and orientation.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// Position \[m\].
    pub position: Point,
    /// Orientation.
    pub orientation: Quaternion,
}

ros_message!(Pose, "geometry_msgs/msg/Pose");
