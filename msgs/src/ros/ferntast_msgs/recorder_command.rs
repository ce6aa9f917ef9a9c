//! `ferntast_msgs/msg/RecorderCommand`.

use serde::{Deserialize, Serialize};

use crate::{RosMessage, ros::std_msgs::Header};

/// What the recorder is to do.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RecorderCommand {
    /// When it was given; no frame.
    pub header: Header,
    /// start, stop or mark.
    pub action: String,
    /// The folder, or what is noted.
    pub label: String,
}

impl RosMessage for RecorderCommand {
    const INTERFACE: &'static str = "ferntast_msgs/msg/RecorderCommand";
}
