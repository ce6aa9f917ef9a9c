//! `geometry_msgs/msg/Quaternion`.

use serde::{Deserialize, Serialize};

use crate::message::ros_message;

/// An orientation as unit quaternion; the default is no rotation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quaternion {
    /// First imaginary part.
    pub x: f64,
    /// Second imaginary part.
    pub y: f64,
    /// Third imaginary part.
    pub z: f64,
    /// Real part.
    pub w: f64,
}

ros_message!(Quaternion, "geometry_msgs/msg/Quaternion");

impl Default for Quaternion {
    fn default() -> Quaternion {
        Quaternion::from([0.0, 0.0, 0.0, 1.0])
    }
}

impl From<[f64; 4]> for Quaternion {
    fn from([x, y, z, w]: [f64; 4]) -> Quaternion {
        Quaternion { x, y, z, w }
    }
}

impl From<&Quaternion> for [f64; 4] {
    fn from(quaternion: &Quaternion) -> [f64; 4] {
        [quaternion.x, quaternion.y, quaternion.z, quaternion.w]
    }
}
