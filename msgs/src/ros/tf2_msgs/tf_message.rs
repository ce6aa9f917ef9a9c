//! `tf2_msgs/msg/TFMessage`.

use serde::{Deserialize, Serialize};

use crate::{RosMessage, ros::geometry_msgs::TransformStamped};

/// Frames and where they are.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TFMessage {
    /// One a frame.
    pub transforms: Vec<TransformStamped>,
}

impl RosMessage for TFMessage {
    const INTERFACE: &'static str = "tf2_msgs/msg/TFMessage";
}
