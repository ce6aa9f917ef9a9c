//! `std_msgs/msg/Header`.

use serde::{Deserialize, Serialize};

use crate::{message::ros_message, ros::builtin_interfaces::Time};

/// What stands at the head of every stamped message.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// When the content was measured or commanded.
    pub stamp: Time,
    /// The coordinate frame of the content; empty where there is none.
    pub frame_id: String,
}

ros_message!(Header, "std_msgs/msg/Header");

impl Header {
    /// A header with that stamp and frame.
    pub fn new(stamp: crate::Time, frame_id: impl Into<String>) -> Header {
        Header {
            stamp: stamp.into(),
            frame_id: frame_id.into(),
        }
    }

    /// The stamp as the rest of ferntast counts time.
    pub fn time(&self) -> crate::Time {
        (&self.stamp).into()
    }
}
