//! CRTK operating state.

use crate::{
    InvalidMessage, Message, Text, Time,
    ros::{crtk_msgs, std_msgs::Header},
};

use super::checks;

/// The operating states of CRTK.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(transparent)]
pub struct OperatingState(pub u8);

impl OperatingState {
    /// Drives off.
    pub const DISABLED: OperatingState = OperatingState(0);
    /// Follows commands.
    pub const ENABLED: OperatingState = OperatingState(1);
    /// Holds passively; latched until resumed.
    pub const PAUSED: OperatingState = OperatingState(2);
    /// Something is broken; drives off until disabled and enabled again.
    pub const FAULT: OperatingState = OperatingState(3);

    /// Every state.
    pub const ALL: [OperatingState; 4] = [
        OperatingState::DISABLED,
        OperatingState::ENABLED,
        OperatingState::PAUSED,
        OperatingState::FAULT,
    ];

    /// Every name, for error texts.
    pub const KNOWN: &str = "DISABLED, ENABLED, PAUSED, FAULT";

    /// The name on the wire; `None` for a code that is no state.
    pub fn name(self) -> Option<&'static str> {
        match self {
            OperatingState::DISABLED => Some("DISABLED"),
            OperatingState::ENABLED => Some("ENABLED"),
            OperatingState::PAUSED => Some("PAUSED"),
            OperatingState::FAULT => Some("FAULT"),
            _ => None,
        }
    }

    /// The state of that name.
    pub fn from_name(name: &str) -> Option<OperatingState> {
        OperatingState::ALL
            .into_iter()
            .find(|known| known.name() == Some(name))
    }
}

/// Operating state of one device, with the reason for it.
/// `crtk_msgs/msg/OperatingState` on the wire (the reason goes to
/// `/diagnostics`: the CRTK type has no room for it, so it is lost there).
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct OperatingStateSample {
    /// Since when the device is in this state, or when it was last published.
    pub stamp: Time,
    /// The state.
    pub state: OperatingState,
    /// 1 when homed.
    pub is_homed: u8,
    /// 1 while a motion or homing is under way.
    pub is_busy: u8,
    /// Keeps the layout free of implicit padding.
    pub reserved: [u8; 5],
    /// Why it is in this state, for people.
    pub reason: Text<96>,
}

checks::no_padding!(OperatingStateSample: Time, OperatingState, u8, u8, [u8; 5], Text<96>);

impl OperatingStateSample {
    /// A device that is homed and not busy.
    pub fn new(stamp: Time, state: OperatingState, reason: &str) -> OperatingStateSample {
        OperatingStateSample {
            stamp,
            state,
            is_homed: 1,
            is_busy: 0,
            reserved: [0; 5],
            reason: Text::new(reason),
        }
    }
}

// SAFETY: `repr(C)` of integers, floats and byte arrays, transparent types around them, no
// pointer: every bit pattern is a value.
unsafe impl Message for OperatingStateSample {
    type Ros = crtk_msgs::OperatingState;

    fn stamp(&self) -> Time {
        self.stamp
    }

    /// The reason is lost: the CRTK type has no room for it.
    fn to_ros(&self) -> crtk_msgs::OperatingState {
        crtk_msgs::OperatingState {
            header: Header::new(self.stamp, ""),
            state: checks::wire_name(self.state.name(), self.state.0),
            is_homed: self.is_homed != 0,
            is_busy: self.is_busy != 0,
        }
    }

    /// The reason comes out empty.
    fn from_ros(ros: &crtk_msgs::OperatingState) -> Result<OperatingStateSample, InvalidMessage> {
        let state = OperatingState::from_name(&ros.state)
            .ok_or_else(|| checks::unknown("state", &ros.state, OperatingState::KNOWN))?;
        let sample = OperatingStateSample {
            is_homed: ros.is_homed.into(),
            is_busy: ros.is_busy.into(),
            ..OperatingStateSample::new(ros.header.time(), state, "")
        };
        sample.check()?;
        Ok(sample)
    }

    fn check(&self) -> Result<(), InvalidMessage> {
        checks::stamp(self.stamp)?;
        checks::code(
            "state",
            self.state.name(),
            self.state.0,
            OperatingState::KNOWN,
        )?;
        checks::flag("is_homed", self.is_homed)?;
        checks::flag("is_busy", self.is_busy)
    }
}
