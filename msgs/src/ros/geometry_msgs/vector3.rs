//! `geometry_msgs/msg/Vector3`.

use serde::{Deserialize, Serialize};

use crate::message::ros_message;

/// A vector without a place.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Vector3 {
    /// Component along x in the unit of the quantity.
    pub x: f64,
    /// Component along y in the unit of the quantity.
    pub y: f64,
    /// Component along z in the unit of the quantity.
    pub z: f64,
}

ros_message!(Vector3, "geometry_msgs/msg/Vector3");

impl From<[f64; 3]> for Vector3 {
    fn from([x, y, z]: [f64; 3]) -> Vector3 {
        Vector3 { x, y, z }
    }
}

impl From<&Vector3> for [f64; 3] {
    fn from(vector: &Vector3) -> [f64; 3] {
        [vector.x, vector.y, vector.z]
    }
}
