//! `geometry_msgs/msg/WrenchStamped`.

use serde::{Deserialize, Serialize};

use crate::{RosMessage, ros::std_msgs::Header};

use super::Wrench;

/// A wrench with its time and frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WrenchStamped {
    /// When, and in which frame.
    pub header: Header,
    /// The wrench.
    pub wrench: Wrench,
}

impl RosMessage for WrenchStamped {
    const INTERFACE: &'static str = "geometry_msgs/msg/WrenchStamped";
}
