//! `geometry_msgs/msg/Transform`.

use serde::{Deserialize, Serialize};

use crate::message::ros_message;

use super::{Quaternion, Vector3};

/// Where a frame is in another.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Transform {
    /// Origin of the child in the parent \[m\].
    pub translation: Vector3,
    /// Rotation from the parent's axes to the child's.
    pub rotation: Quaternion,
}

ros_message!(Transform, "geometry_msgs/msg/Transform");
