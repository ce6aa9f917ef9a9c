//! `tf2_msgs/msg/TFMessage`.

use serde::{Deserialize, Serialize};

use crate::{message::ros_message, ros::geometry_msgs::TransformStamped};

/// Frames and where they are.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TFMessage {
    /// One a frame.
    pub transforms: Vec<TransformStamped>,
}

ros_message!(TFMessage, "tf2_msgs/msg/TFMessage");
