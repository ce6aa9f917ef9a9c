//! `sensor_msgs/msg/Temperature`.

use serde::{Deserialize, Serialize};

use crate::{message::ros_message, ros::std_msgs::Header};

/// A temperature.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Temperature {
    /// When, and in which frame.
    pub header: Header,
    /// Temperature \[degC\].
    pub temperature: f64,
    /// Variance \[degC²\]; 0 where unknown.
    pub variance: f64,
}

ros_message!(Temperature, "sensor_msgs/msg/Temperature");
