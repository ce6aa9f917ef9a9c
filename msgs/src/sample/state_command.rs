//! CRTK state command.

use crate::{
    InvalidMessage, Message, Time,
    ros::{crtk_msgs::StringStamped, std_msgs::Header},
};

use super::checks;

/// The state commands of CRTK.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(transparent)]
pub struct StateCommand(pub u8);

impl StateCommand {
    /// Drives on.
    pub const ENABLE: StateCommand = StateCommand(1);
    /// Drives off.
    pub const DISABLE: StateCommand = StateCommand(2);
    /// Hold.
    pub const PAUSE: StateCommand = StateCommand(3);
    /// Leave the hold: re-arm.
    pub const RESUME: StateCommand = StateCommand(4);

    /// Every command.
    pub const ALL: [StateCommand; 4] = [
        StateCommand::ENABLE,
        StateCommand::DISABLE,
        StateCommand::PAUSE,
        StateCommand::RESUME,
    ];

    /// Every name, for error texts.
    pub const KNOWN: &str = "enable, disable, pause, resume";

    /// The word on the wire; `None` for a code that is no command.
    pub fn name(self) -> Option<&'static str> {
        match self {
            StateCommand::ENABLE => Some("enable"),
            StateCommand::DISABLE => Some("disable"),
            StateCommand::PAUSE => Some("pause"),
            StateCommand::RESUME => Some("resume"),
            _ => None,
        }
    }

    /// The command of that name.
    pub fn from_name(name: &str) -> Option<StateCommand> {
        StateCommand::ALL
            .into_iter()
            .find(|known| known.name() == Some(name))
    }
}

/// A state command to one device. `crtk_msgs/msg/StringStamped` on the wire.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct StateCommandSample {
    /// When it was given.
    pub stamp: Time,
    /// The command.
    pub command: StateCommand,
    /// Keeps the layout free of implicit padding.
    pub reserved: [u8; 7],
}

checks::no_padding!(StateCommandSample: Time, StateCommand, [u8; 7]);

impl StateCommandSample {
    /// That command.
    pub const fn new(stamp: Time, command: StateCommand) -> StateCommandSample {
        StateCommandSample {
            stamp,
            command,
            reserved: [0; 7],
        }
    }
}

// SAFETY: `repr(C)` of integers, floats and byte arrays, transparent types around them, no
// pointer: every bit pattern is a value.
unsafe impl Message for StateCommandSample {
    type Ros = StringStamped;

    fn stamp(&self) -> Time {
        self.stamp
    }

    fn to_ros(&self) -> StringStamped {
        StringStamped {
            header: Header::new(self.stamp, ""),
            string: checks::wire_name(self.command.name(), self.command.0),
        }
    }

    fn from_ros(ros: &StringStamped) -> Result<StateCommandSample, InvalidMessage> {
        let command = StateCommand::from_name(&ros.string)
            .ok_or_else(|| checks::unknown("string", &ros.string, StateCommand::KNOWN))?;
        let sample = StateCommandSample::new(ros.header.time(), command);
        sample.check()?;
        Ok(sample)
    }

    fn check(&self) -> Result<(), InvalidMessage> {
        checks::stamp(self.stamp)?;
        checks::code(
            "string",
            self.command.name(),
            self.command.0,
            StateCommand::KNOWN,
        )
    }
}
