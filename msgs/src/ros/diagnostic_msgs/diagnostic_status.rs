//! `diagnostic_msgs/msg/DiagnosticStatus`.

use serde::{Deserialize, Serialize};

use crate::message::ros_message;

use super::KeyValue;

/// How one component is doing.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DiagnosticStatus {
    /// Severity: 0 ok, 1 warning, 2 error, 3 stale.
    pub level: u8,
    /// The component.
    pub name: String,
    /// What there is to say, for people.
    pub message: String,
    /// Identity of the hardware.
    pub hardware_id: String,
    /// Numbers and further texts.
    pub values: Vec<KeyValue>,
}

ros_message!(DiagnosticStatus, "diagnostic_msgs/msg/DiagnosticStatus");
