//! `ferntast_msgs/msg/LinkCommand`.

use serde::{Deserialize, Serialize};

use crate::{RosMessage, ros::std_msgs::Header};

/// What the channel is to do to frames.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LinkCommand {
    /// When it was given; no frame.
    pub header: Header,
    /// Both ways together \[s\].
    pub round_trip: f64,
    /// Largest deviation of a frame's delay \[s\].
    pub jitter: f64,
    /// Share of frames lost each way, 0 … 1.
    pub loss: f64,
}

impl RosMessage for LinkCommand {
    const INTERFACE: &'static str = "ferntast_msgs/msg/LinkCommand";
}
