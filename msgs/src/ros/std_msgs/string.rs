//! `std_msgs/msg/String`.

use serde::{Deserialize, Serialize};

use crate::message::ros_message;

/// A text.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct String {
    /// The text.
    pub data: std::string::String,
}

ros_message!(String, "std_msgs/msg/String");
