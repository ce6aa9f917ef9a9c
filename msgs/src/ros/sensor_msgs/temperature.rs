//! `sensor_msgs/msg/Temperature`.

use serde::{Deserialize, Serialize};

use crate::{RosMessage, ros::std_msgs::Header};

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

impl RosMessage for Temperature {
    const INTERFACE: &'static str = "sensor_msgs/msg/Temperature";
}
