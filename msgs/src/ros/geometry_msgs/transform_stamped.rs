//! `geometry_msgs/msg/TransformStamped`.

use serde::{Deserialize, Serialize};

use crate::{message::ros_message, ros::std_msgs::Header};

use super::Transform;

/// Where a frame is in another, and when.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TransformStamped {
    /// When, and the parent frame.
    pub header: Header,
    /// The child frame.
    pub child_frame_id: String,
    /// Where the child is in the parent.
    pub transform: Transform,
}

ros_message!(TransformStamped, "geometry_msgs/msg/TransformStamped");
