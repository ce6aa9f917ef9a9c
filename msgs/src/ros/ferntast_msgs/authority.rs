//! `ferntast_msgs/msg/Authority`.

use serde::{Deserialize, Serialize};

use crate::{RosMessage, ros::std_msgs::Header};

/// Who holds the authority over the arm.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Authority {
    /// When it was decided; no frame.
    pub header: Header,
    /// Identity of the source that holds the authority, hexadecimal; empty while nobody does.
    pub holder: String,
    /// Identity of the source refused last, hexadecimal; empty when none was.
    pub refused: String,
    /// Commands refused so far because another source holds the authority.
    pub refused_count: u64,
    /// Why, for people.
    pub reason: String,
}

impl RosMessage for Authority {
    const INTERFACE: &'static str = "ferntast_msgs/msg/Authority";
}
