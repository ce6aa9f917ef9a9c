//! Command to the servo's friction feed-forward.

use crate::{
    InvalidMessage, Message, Time,
    ros::{crtk_msgs::StringStamped, std_msgs::Header},
};

use super::checks;

/// What the servo's friction feed-forward can be told to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(transparent)]
pub struct FrictionCommand(pub u8);

impl FrictionCommand {
    /// Use what the twin found.
    pub const TAKE_OVER: FrictionCommand = FrictionCommand(1);
    /// Use what is configured, at every joint.
    pub const GIVE_BACK: FrictionCommand = FrictionCommand(2);

    /// Every command.
    pub const ALL: [FrictionCommand; 2] = [FrictionCommand::TAKE_OVER, FrictionCommand::GIVE_BACK];

    /// Every name, for error texts.
    pub const KNOWN: &str = "take_over, give_back";

    /// The word on the wire; `None` for a code that is no command.
    pub fn name(self) -> Option<&'static str> {
        match self {
            FrictionCommand::TAKE_OVER => Some("take_over"),
            FrictionCommand::GIVE_BACK => Some("give_back"),
            _ => None,
        }
    }

    /// The command of that name.
    pub fn from_name(name: &str) -> Option<FrictionCommand> {
        FrictionCommand::ALL
            .into_iter()
            .find(|known| known.name() == Some(name))
    }
}

/// A command to the friction feed-forward. `crtk_msgs/msg/StringStamped` on the wire.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct FrictionCommandSample {
    /// When it was given.
    pub stamp: Time,
    /// The command.
    pub command: FrictionCommand,
    /// Keeps the layout free of implicit padding.
    pub reserved: [u8; 7],
}

checks::no_padding!(FrictionCommandSample: Time, FrictionCommand, [u8; 7]);

impl FrictionCommandSample {
    /// That command.
    pub const fn new(stamp: Time, command: FrictionCommand) -> FrictionCommandSample {
        FrictionCommandSample {
            stamp,
            command,
            reserved: [0; 7],
        }
    }
}

// SAFETY: `repr(C)` of integers and byte arrays, transparent types around them, no pointer:
// every bit pattern is a value.
unsafe impl Message for FrictionCommandSample {
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

    fn from_ros(ros: &StringStamped) -> Result<FrictionCommandSample, InvalidMessage> {
        let command = FrictionCommand::from_name(&ros.string)
            .ok_or_else(|| checks::unknown("string", &ros.string, FrictionCommand::KNOWN))?;
        let sample = FrictionCommandSample::new(ros.header.time(), command);
        sample.check()?;
        Ok(sample)
    }

    fn check(&self) -> Result<(), InvalidMessage> {
        checks::stamp(self.stamp)?;
        checks::code(
            "string",
            self.command.name(),
            self.command.0,
            FrictionCommand::KNOWN,
        )
    }
}
