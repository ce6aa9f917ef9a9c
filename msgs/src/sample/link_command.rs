//! What the channel is to do.

use crate::{
    InvalidMessage, Message, Time,
    ros::{ferntast_msgs::LinkCommand, std_msgs::Header},
};

use super::checks;

/// What an emulated channel is to do to frames from now on.
/// `ferntast_msgs/msg/LinkCommand` on the wire.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct LinkCommandSample {
    /// When it was given.
    pub stamp: Time,
    /// Both ways together, half of it each \[s\].
    pub round_trip: f64,
    /// Largest deviation of a frame's delay, uniformly distributed \[s\].
    pub jitter: f64,
    /// Share of frames lost each way, independently, 0 … 1.
    pub loss: f64,
}

checks::no_padding!(LinkCommandSample: Time, f64, f64, f64);

// SAFETY: `repr(C)` of integers and floats, no pointer: every bit pattern is a value.
unsafe impl Message for LinkCommandSample {
    type Ros = LinkCommand;

    fn stamp(&self) -> Time {
        self.stamp
    }

    fn to_ros(&self) -> LinkCommand {
        LinkCommand {
            header: Header::new(self.stamp, ""),
            round_trip: self.round_trip,
            jitter: self.jitter,
            loss: self.loss,
        }
    }

    fn from_ros(ros: &LinkCommand) -> Result<LinkCommandSample, InvalidMessage> {
        let sample = LinkCommandSample {
            stamp: ros.header.time(),
            round_trip: ros.round_trip,
            jitter: ros.jitter,
            loss: ros.loss,
        };
        sample.check()?;
        Ok(sample)
    }

    /// Bounds are those of the channel, which refuses what is beyond them.
    fn check(&self) -> Result<(), InvalidMessage> {
        checks::stamp(self.stamp)?;
        checks::finite("round_trip", &[self.round_trip])?;
        checks::finite("jitter", &[self.jitter])?;
        checks::finite("loss", &[self.loss])
    }
}
