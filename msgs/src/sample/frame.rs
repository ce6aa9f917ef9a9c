//! Coordinate frames.

use super::{Named, codes::codes};
use crate::{InvalidMessage, Time, ros::std_msgs::Header};

codes! {
    /// The coordinate frame that a pose or wrench is expressed in. On the wire of
    /// ROS 2 it is `header.frame_id`.
    pub struct Frame known "(empty), follower_base, leader_base, contact" {
        /// No frame given (`""`).
        NONE = 0 "",
        /// Base of the arm, at joint 1: x along the stretched arm, z along the joint axes.
        FOLLOWER_BASE = 1 "follower_base",
        /// Base of the haptic master; axes as in `follower_base`, origin in the middle of its workspace.
        LEADER_BASE = 2 "leader_base",
        /// At the tip on the contour: x tangential, z normal (out of the surface).
        CONTACT = 3 "contact",
    }
}

/// Where the frame stands on the wire.
const FIELD: &str = "header.frame_id";

impl Frame {
    /// Refuses a code that is no frame.
    pub(super) fn check(self) -> Result<(), InvalidMessage> {
        Named::check(self, FIELD)
    }

    /// The header of a message in this frame.
    pub(super) fn header(self, stamp: Time) -> Header {
        Header::new(stamp, self.wire_name())
    }

    /// The frame of a message with that header.
    pub(super) fn of(header: &Header) -> Result<Frame, InvalidMessage> {
        Frame::from_wire(FIELD, &header.frame_id)
    }
}
