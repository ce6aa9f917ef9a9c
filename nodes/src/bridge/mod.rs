//! What carries topics from one bus to another: to and from ROS 2, into a
//! recording and out of it, to Foxglove.

mod choice_parameter;
pub mod forwarder;
mod forwarding_loop;
pub mod foxglove;
pub mod gateway;
pub mod others;
pub mod player;
pub mod recorder;
pub mod state_services;
