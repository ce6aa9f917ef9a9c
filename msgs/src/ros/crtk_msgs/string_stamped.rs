//! `crtk_msgs/msg/StringStamped`.

use serde::{Deserialize, Serialize};

use crate::{message::ros_message, ros::std_msgs::Header};

/// A text with its time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StringStamped {
    /// When, and in which frame.
    pub header: Header,
    /// The text.
    pub string: String,
}

ros_message!(StringStamped, "crtk_msgs/msg/StringStamped");
