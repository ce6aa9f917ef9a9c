//! `diagnostic_msgs/msg/KeyValue`.

use serde::{Deserialize, Serialize};

use crate::message::ros_message;

/// A value with its name.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct KeyValue {
    /// The name.
    pub key: String,
    /// The value as text.
    pub value: String,
}

ros_message!(KeyValue, "diagnostic_msgs/msg/KeyValue");

impl KeyValue {
    /// A value with that name.
    pub fn new(key: impl Into<String>, value: impl Into<String>) -> KeyValue {
        KeyValue {
            key: key.into(),
            value: value.into(),
        }
    }
}
