//! What the recorder is to do.

use crate::{
    InvalidMessage, Message, Text, Time,
    ros::{ferntast_msgs::RecorderCommand, std_msgs::Header},
};

use super::checks;

/// What a recorder can be told.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(transparent)]
pub struct RecorderAction(pub u8);

impl RecorderAction {
    /// Write from now on.
    pub const START: RecorderAction = RecorderAction(1);
    /// Write no longer.
    pub const STOP: RecorderAction = RecorderAction(2);
    /// Note something: the command itself, in the recording.
    pub const MARK: RecorderAction = RecorderAction(3);

    /// Every action.
    pub const ALL: [RecorderAction; 3] = [
        RecorderAction::START,
        RecorderAction::STOP,
        RecorderAction::MARK,
    ];

    /// Every name, for error texts.
    pub const KNOWN: &str = "start, stop, mark";

    /// The word on the wire; `None` for a code that is no action.
    pub fn name(self) -> Option<&'static str> {
        match self {
            RecorderAction::START => Some("start"),
            RecorderAction::STOP => Some("stop"),
            RecorderAction::MARK => Some("mark"),
            _ => None,
        }
    }

    /// The action of that name.
    pub fn from_name(name: &str) -> Option<RecorderAction> {
        RecorderAction::ALL
            .into_iter()
            .find(|known| known.name() == Some(name))
    }
}

/// What the recorder is to do. `ferntast_msgs/msg/RecorderCommand` on the wire.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct RecorderCommandSample {
    /// When it was given.
    pub stamp: Time,
    /// Start: the folder, relative to the session's, empty for one named after
    /// the time. Mark: what is noted.
    pub label: Text<96>,
    /// What to do.
    pub action: RecorderAction,
    /// Keeps the layout free of implicit padding.
    pub reserved: [u8; 7],
}

checks::no_padding!(RecorderCommandSample: Time, Text<96>, RecorderAction, [u8; 7]);

impl RecorderCommandSample {
    /// A command with its label, cut to 96 bytes.
    pub fn new(stamp: Time, action: RecorderAction, label: &str) -> RecorderCommandSample {
        RecorderCommandSample {
            stamp,
            label: Text::new(label),
            action,
            reserved: [0; 7],
        }
    }
}

// SAFETY: `repr(C)` of integers and byte arrays, transparent types around them, no
// pointer: every bit pattern is a value.
unsafe impl Message for RecorderCommandSample {
    type Ros = RecorderCommand;

    fn stamp(&self) -> Time {
        self.stamp
    }

    fn to_ros(&self) -> RecorderCommand {
        RecorderCommand {
            header: Header::new(self.stamp, ""),
            action: checks::wire_name(self.action.name(), self.action.0),
            label: self.label.as_str().to_owned(),
        }
    }

    fn from_ros(ros: &RecorderCommand) -> Result<RecorderCommandSample, InvalidMessage> {
        let action = RecorderAction::from_name(&ros.action)
            .ok_or_else(|| checks::unknown("action", &ros.action, RecorderAction::KNOWN))?;
        let sample = RecorderCommandSample::new(ros.header.time(), action, &ros.label);
        sample.check()?;
        Ok(sample)
    }

    fn check(&self) -> Result<(), InvalidMessage> {
        checks::stamp(self.stamp)?;
        checks::code(
            "action",
            self.action.name(),
            self.action.0,
            RecorderAction::KNOWN,
        )
    }
}
