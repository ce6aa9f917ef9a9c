//! `diagnostic_msgs/msg/DiagnosticArray`.

use serde::{Deserialize, Serialize};

use crate::{RosMessage, ros::std_msgs::Header};

use super::DiagnosticStatus;

/// How several components are doing.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DiagnosticArray {
    /// When.
    pub header: Header,
    /// One status a component.
    pub status: Vec<DiagnosticStatus>,
}

impl RosMessage for DiagnosticArray {
    const INTERFACE: &'static str = "diagnostic_msgs/msg/DiagnosticArray";
}
