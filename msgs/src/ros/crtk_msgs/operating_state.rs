//! `crtk_msgs/msg/OperatingState`.

use serde::{Deserialize, Serialize};

use crate::{message::ros_message, ros::std_msgs::Header};

/// Operating state of a device.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OperatingState {
    /// When, and in which frame.
    pub header: Header,
    /// DISABLED, ENABLED, PAUSED or FAULT.
    pub state: String,
    /// Homed.
    pub is_homed: bool,
    /// A motion or homing is under way.
    pub is_busy: bool,
}

ros_message!(OperatingState, "crtk_msgs/msg/OperatingState");
