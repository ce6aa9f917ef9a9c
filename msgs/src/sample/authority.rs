//! Who holds the master.

use crate::{
    InvalidMessage, Message, Text, Time,
    ros::{ferntast_msgs::Authority, std_msgs::Header},
};

use super::checks;

/// Which source of `/leader/measured_cp` drives the arm, and which was
/// refused last. `ferntast_msgs/msg/Authority` on the wire.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct AuthoritySample {
    /// When it was decided or last published.
    pub stamp: Time,
    /// Identity of the source that holds the authority; 0 while nobody does.
    pub holder: u64,
    /// Identity of the source that was refused last; 0 when none was.
    pub refused: u64,
    /// Commands refused so far because another source holds the authority.
    pub refused_count: u64,
    /// Why, for people.
    pub reason: Text<96>,
}

checks::no_padding!(AuthoritySample: Time, u64, u64, u64, Text<96>);

impl AuthoritySample {
    /// Nobody holds the authority, nobody was refused.
    pub const fn nobody(stamp: Time) -> AuthoritySample {
        AuthoritySample {
            stamp,
            holder: 0,
            refused: 0,
            refused_count: 0,
            reason: Text::EMPTY,
        }
    }
}

// SAFETY: `repr(C)` of integers, floats and byte arrays, transparent types around them, no
// pointer: every bit pattern is a value.
unsafe impl Message for AuthoritySample {
    type Ros = Authority;

    fn stamp(&self) -> Time {
        self.stamp
    }

    fn to_ros(&self) -> Authority {
        Authority {
            header: Header::new(self.stamp, ""),
            holder: identity_text(self.holder),
            refused: identity_text(self.refused),
            refused_count: self.refused_count,
            reason: self.reason.as_str().to_owned(),
        }
    }

    fn from_ros(ros: &Authority) -> Result<AuthoritySample, InvalidMessage> {
        let sample = AuthoritySample {
            stamp: ros.header.time(),
            holder: identity("holder", &ros.holder)?,
            refused: identity("refused", &ros.refused)?,
            refused_count: ros.refused_count,
            reason: Text::new(&ros.reason),
        };
        sample.check()?;
        Ok(sample)
    }

    fn check(&self) -> Result<(), InvalidMessage> {
        checks::stamp(self.stamp)
    }
}

/// 16 hexadecimal digits; empty for 0, which is nobody.
fn identity_text(identity: u64) -> String {
    match identity {
        0 => String::new(),
        _ => format!("{identity:016x}"),
    }
}

/// The way back from [`identity_text`].
fn identity(field: &'static str, text: &str) -> Result<u64, InvalidMessage> {
    if text.is_empty() {
        return Ok(0);
    }
    let refuse = || checks::unknown(field, text, "(empty), 1 to 16 hexadecimal digits");
    // from_str_radix takes a leading plus sign, which is no digit.
    if text.starts_with('+') {
        return Err(refuse());
    }
    u64::from_str_radix(text, 16).map_err(|_| refuse())
}
