//! `geometry_msgs/msg/PoseStamped`.

use serde::{Deserialize, Serialize};

use crate::{message::ros_message, ros::std_msgs::Header};

use super::Pose;

/// A pose with its time and frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PoseStamped {
    /// When, and in which frame.
    pub header: Header,
    /// The pose.
    pub pose: Pose,
}

ros_message!(PoseStamped, "geometry_msgs/msg/PoseStamped");
