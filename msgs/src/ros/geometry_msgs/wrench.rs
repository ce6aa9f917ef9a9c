//! `geometry_msgs/msg/Wrench`.

use serde::{Deserialize, Serialize};

use crate::message::ros_message;

use super::Vector3;

/// A force and torque.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Wrench {
    /// Force \[N\].
    pub force: Vector3,
    /// Torque \[Nm\].
    pub torque: Vector3,
}

ros_message!(Wrench, "geometry_msgs/msg/Wrench");
