//! `std_msgs/msg/String`.

use serde::{Deserialize, Serialize};

use crate::RosMessage;

/// A text.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct String {
    /// The text.
    pub data: std::string::String,
}

impl RosMessage for String {
    const INTERFACE: &'static str = "std_msgs/msg/String";
}
