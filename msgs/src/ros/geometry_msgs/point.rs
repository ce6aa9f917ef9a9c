//! `geometry_msgs/msg/Point`.

use serde::{Deserialize, Serialize};

use crate::message::ros_message;

/// A position.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Component along x \[m\].
    pub x: f64,
    /// Component along y \[m\].
    pub y: f64,
    /// Component along z \[m\].
    pub z: f64,
}

ros_message!(Point, "geometry_msgs/msg/Point");

impl From<[f64; 3]> for Point {
    fn from([x, y, z]: [f64; 3]) -> Point {
        Point { x, y, z }
    }
}

impl From<&Point> for [f64; 3] {
    fn from(point: &Point) -> [f64; 3] {
        [point.x, point.y, point.z]
    }
}
