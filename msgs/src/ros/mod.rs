//! The messages in their ROS 2 form: a module a package, as in ROS 2.
//!
//! Fields stand in the order of the `.msg` files, so that CDR comes out right;
//! a test compares the two. Those of `ferntast_msgs` stand beside their samples.

pub mod builtin_interfaces;
pub mod crtk_msgs;
pub mod diagnostic_msgs;
pub mod geometry_msgs;
pub mod sensor_msgs;
pub mod std_msgs;
pub mod tf2_msgs;
