//! `crtk_msgs/msg/StringStamped`.

use serde::{Deserialize, Serialize};

use crate::{RosMessage, ros::std_msgs::Header};

/// A text with its time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StringStamped {
    /// When, and in which frame.
    pub header: Header,
    /// The text.
    pub string: String,
}

impl RosMessage for StringStamped {
    const INTERFACE: &'static str = "crtk_msgs/msg/StringStamped";
}
