//! Sessions in real time with all their processes, against real peers.
//!
//! No bound here hangs on milliseconds: a hold that a busy machine causes is
//! left again. Bounds in time are in `timing`.

#[path = "../../shared/arm_of_three.rs"]
mod arm_of_three;
mod bad_frames;
mod console;
mod console_gamepad;
mod console_space;
mod console_trouble;
mod crashes;
mod ends_on_two_hosts;
mod fleet;
mod foreign_bags;
mod haply;
mod lab_bench;
mod lab_mapping;
mod lab_page;
mod lab_subjects;
mod layout;
mod leader;
mod link_tls;
mod masters;
mod own_tools;
mod refusals;
mod ros;
mod ros_arm;
mod router_config;
mod session;
mod soak;
mod tool;
mod twin;
mod zenoh;
