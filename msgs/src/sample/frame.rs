//! Coordinate frames.

use crate::{InvalidMessage, Time, ros::std_msgs::Header};

use super::checks;

/// The coordinate frame that a pose or wrench is expressed in. On the wire of
/// ROS 2 it is `header.frame_id`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(transparent)]
pub struct Frame(pub u32);

impl Frame {
    /// No frame given (`""`).
    pub const NONE: Frame = Frame(0);
    /// Base of the arm, at joint 1: x along the stretched arm, z along the joint axes.
    pub const FOLLOWER_BASE: Frame = Frame(1);
    /// Base of the haptic master; axes as in `follower_base`, origin in the middle of its workspace.
    pub const LEADER_BASE: Frame = Frame(2);
    /// At the tip on the contour: x tangential, z normal (out of the surface).
    pub const CONTACT: Frame = Frame(3);

    /// Every frame.
    pub const ALL: [Frame; 4] = [
        Frame::NONE,
        Frame::FOLLOWER_BASE,
        Frame::LEADER_BASE,
        Frame::CONTACT,
    ];

    /// Every name, for error texts.
    pub const KNOWN: &str = "(empty), follower_base, leader_base, contact";

    /// The name on the wire; `None` for a code that is no frame.
    pub fn name(self) -> Option<&'static str> {
        match self {
            Frame::NONE => Some(""),
            Frame::FOLLOWER_BASE => Some("follower_base"),
            Frame::LEADER_BASE => Some("leader_base"),
            Frame::CONTACT => Some("contact"),
            _ => None,
        }
    }

    /// The frame of that name.
    pub fn from_name(name: &str) -> Option<Frame> {
        Frame::ALL
            .into_iter()
            .find(|frame| frame.name() == Some(name))
    }

    /// Refuses a code that is no frame.
    pub(super) fn check(self) -> Result<(), InvalidMessage> {
        checks::code("header.frame_id", self.name(), self.0, Frame::KNOWN)
    }

    /// The header of a message in this frame.
    pub(super) fn header(self, stamp: Time) -> Header {
        Header::new(stamp, checks::wire_name(self.name(), self.0))
    }

    /// The frame of a message with that header.
    pub(super) fn of(header: &Header) -> Result<Frame, InvalidMessage> {
        Frame::from_name(&header.frame_id)
            .ok_or_else(|| checks::unknown("header.frame_id", &header.frame_id, Frame::KNOWN))
    }
}
