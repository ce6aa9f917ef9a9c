//! `ferntast_msgs/msg/RecorderStatus`.

use serde::{Deserialize, Serialize};

use crate::{RosMessage, ros::std_msgs::Header};

/// What the recorder does.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RecorderStatus {
    /// When it was told; no frame.
    pub header: Header,
    /// It writes.
    pub recording: bool,
    /// Where to, or where to it wrote last.
    pub folder: String,
    /// Messages written there.
    pub messages: u64,
}

impl RosMessage for RecorderStatus {
    const INTERFACE: &'static str = "ferntast_msgs/msg/RecorderStatus";
}
