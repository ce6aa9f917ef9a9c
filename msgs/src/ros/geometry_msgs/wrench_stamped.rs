//! `geometry_msgs/msg/WrenchStamped`.

use serde::{Deserialize, Serialize};

use crate::{message::ros_message, ros::std_msgs::Header};

use super::Wrench;

/// A wrench with its time and frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WrenchStamped {
    /// When, and in which frame.
    pub header: Header,
    /// The wrench.
    pub wrench: Wrench,
}

ros_message!(WrenchStamped, "geometry_msgs/msg/WrenchStamped");
