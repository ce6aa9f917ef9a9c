//! `std_msgs/msg/Float64MultiArray` and what it is made of.

use serde::{Deserialize, Serialize};

use crate::message::ros_message;

/// One dimension of an array.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MultiArrayDimension {
    /// What it is of.
    pub label: String,
    /// How many numbers it has.
    pub size: u32,
    /// How many numbers one of its rows takes.
    pub stride: u32,
}

ros_message!(MultiArrayDimension, "std_msgs/msg/MultiArrayDimension");

/// How the numbers of an array lie.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MultiArrayLayout {
    /// The outermost dimension first; none is a plain list.
    pub dim: Vec<MultiArrayDimension>,
    /// Numbers before the first.
    pub data_offset: u32,
}

ros_message!(MultiArrayLayout, "std_msgs/msg/MultiArrayLayout");

/// Numbers in an array.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Float64MultiArray {
    /// How they lie.
    pub layout: MultiArrayLayout,
    /// The numbers.
    pub data: Vec<f64>,
}

ros_message!(Float64MultiArray, "std_msgs/msg/Float64MultiArray");
