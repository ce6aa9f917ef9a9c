//! What stands between the arm's topics and an arm: takes `/follower/servo_jf`,
//! publishes `/follower/measured_js`, `/follower/motor_js`, temperatures and
//! the robot's description.
//!
//! A driver is a row of the graph of nodes, and a function that reads its kind
//! of arm's file. Vendor signs and offsets are turned here, once.

pub mod simulated;
