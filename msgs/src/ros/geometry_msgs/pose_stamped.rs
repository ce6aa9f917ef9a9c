//! `geometry_msgs/msg/PoseStamped`.

use serde::{Deserialize, Serialize};

use crate::{RosMessage, ros::std_msgs::Header};

use super::Pose;

/// A pose with its time and frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PoseStamped {
    /// When, and in which frame.
    pub header: Header,
    /// The pose.
    pub pose: Pose,
}

impl RosMessage for PoseStamped {
    const INTERFACE: &'static str = "geometry_msgs/msg/PoseStamped";
}
