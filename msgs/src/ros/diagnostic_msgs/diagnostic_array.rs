//! `diagnostic_msgs/msg/DiagnosticArray`.

use serde::{Deserialize, Serialize};

use crate::{message::ros_message, ros::std_msgs::Header};

use super::DiagnosticStatus;

/// How several components are doing.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DiagnosticArray {
    /// When.
    pub header: Header,
    /// One status a component.
    pub status: Vec<DiagnosticStatus>,
}

ros_message!(DiagnosticArray, "diagnostic_msgs/msg/DiagnosticArray");
