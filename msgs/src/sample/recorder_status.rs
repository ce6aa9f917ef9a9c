//! What the recorder does.

use crate::{
    InvalidMessage, Message, Text, Time,
    ros::{ferntast_msgs::RecorderStatus, std_msgs::Header},
};

use super::checks;

/// What the recorder does. `ferntast_msgs/msg/RecorderStatus` on the wire.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct RecorderStatusSample {
    /// When it was told.
    pub stamp: Time,
    /// Messages written in the folder.
    pub messages: u64,
    /// Where to it writes, or wrote last.
    pub folder: Text<96>,
    /// 1 while it writes.
    pub recording: u8,
    /// Keeps the layout free of implicit padding.
    pub reserved: [u8; 7],
}

checks::no_padding!(RecorderStatusSample: Time, u64, Text<96>, u8, [u8; 7]);

impl RecorderStatusSample {
    /// Nothing was recorded yet.
    pub const fn idle(stamp: Time) -> RecorderStatusSample {
        RecorderStatusSample {
            stamp,
            messages: 0,
            folder: Text::EMPTY,
            recording: 0,
            reserved: [0; 7],
        }
    }
}

// SAFETY: `repr(C)` of integers and byte arrays, transparent types around them, no
// pointer: every bit pattern is a value.
unsafe impl Message for RecorderStatusSample {
    type Ros = RecorderStatus;

    fn stamp(&self) -> Time {
        self.stamp
    }

    fn to_ros(&self) -> RecorderStatus {
        RecorderStatus {
            header: Header::new(self.stamp, ""),
            recording: self.recording != 0,
            folder: self.folder.as_str().to_owned(),
            messages: self.messages,
        }
    }

    fn from_ros(ros: &RecorderStatus) -> Result<RecorderStatusSample, InvalidMessage> {
        let sample = RecorderStatusSample {
            stamp: ros.header.time(),
            messages: ros.messages,
            folder: Text::new(&ros.folder),
            recording: ros.recording.into(),
            reserved: [0; 7],
        };
        sample.check()?;
        Ok(sample)
    }

    fn check(&self) -> Result<(), InvalidMessage> {
        checks::stamp(self.stamp)?;
        checks::flag("recording", self.recording)
    }
}
