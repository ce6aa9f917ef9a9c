//! `ferntast_msgs/msg/FrictionStatus`.

use serde::{Deserialize, Serialize};

use crate::{RosMessage, ros::std_msgs::Header};

/// The friction that the servo feeds forward at one joint. The lists go
/// together, one element a parameter.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FrictionStatus {
    /// When it was told; no frame.
    pub header: Header,
    /// Which joint: joint_1 or joint_2.
    pub joint: String,
    /// Where the targets come from: configured or twin.
    pub source: String,
    /// Names of the parameters, as in the arm's file.
    pub names: Vec<String>,
    /// Values by the arm's file.
    pub configured: Vec<f64>,
    /// Values in use now.
    pub values: Vec<f64>,
    /// What the values are, or are on their way to.
    pub targets: Vec<f64>,
    /// Commands dealt with since the start.
    pub commands: u64,
    /// Why the last one was refused; empty where it was not.
    pub refused: String,
}

impl RosMessage for FrictionStatus {
    const INTERFACE: &'static str = "ferntast_msgs/msg/FrictionStatus";
}
