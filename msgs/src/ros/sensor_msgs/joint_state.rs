//! `sensor_msgs/msg/JointState`.

use serde::{Deserialize, Serialize};

use crate::{message::ros_message, ros::std_msgs::Header};

/// State or command of joints. A sequence that is empty is not given; the others
/// are as long as `name`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct JointState {
    /// When, and in which frame.
    pub header: Header,
    /// Names of the joints.
    pub name: Vec<String>,
    /// Positions \[rad\].
    pub position: Vec<f64>,
    /// Velocities \[rad/s\].
    pub velocity: Vec<f64>,
    /// Torques \[Nm\].
    pub effort: Vec<f64>,
}

ros_message!(JointState, "sensor_msgs/msg/JointState");
