//! Command to change the delay law.

use crate::{
    InvalidMessage, Message, Text, Time,
    ros::{crtk_msgs::StringStamped, std_msgs::Header},
};

use super::checks;

/// Command to the link: another delay law. `crtk_msgs/msg/StringStamped` on
/// the wire. Which laws there are, the link knows.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct LawCommandSample {
    /// When it was given.
    pub stamp: Time,
    /// The law, as in configurations.
    pub law: Text<24>,
}

checks::no_padding!(LawCommandSample: Time, Text<24>);

// SAFETY: `repr(C)` of an integer and a byte array, transparent types around them, no pointer:
// every bit pattern is a value.
unsafe impl Message for LawCommandSample {
    type Ros = StringStamped;

    fn stamp(&self) -> Time {
        self.stamp
    }

    fn to_ros(&self) -> StringStamped {
        StringStamped {
            header: Header::new(self.stamp, ""),
            string: self.law.as_str().to_owned(),
        }
    }

    fn from_ros(ros: &StringStamped) -> Result<LawCommandSample, InvalidMessage> {
        let sample = LawCommandSample {
            stamp: ros.header.time(),
            law: Text::new(&ros.string),
        };
        if sample.law.as_str() != ros.string {
            return Err(checks::unknown("string", &ros.string, KNOWN));
        }
        sample.check()?;
        Ok(sample)
    }

    fn check(&self) -> Result<(), InvalidMessage> {
        checks::stamp(self.stamp)?;
        if self.law.is_empty() {
            return Err(checks::unknown("string", "", KNOWN));
        }
        Ok(())
    }
}

/// What can name a law, for error texts.
const KNOWN: &str = "the name of a delay law, such as wave";
