//! The friction that the servo feeds forward.

use crate::{
    InvalidMessage, Message, Text, Time,
    ros::{ferntast_msgs::FrictionStatus, std_msgs::Header},
};

use super::{
    JOINT_NAMES, checks,
    lists::{self, MOST_PARAMETERS, Numbers},
};

/// Where the friction that is fed forward comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(transparent)]
pub struct FrictionSource(pub u8);

impl FrictionSource {
    /// The arm's file.
    pub const CONFIGURED: FrictionSource = FrictionSource(0);
    /// The twin.
    pub const TWIN: FrictionSource = FrictionSource(1);

    /// Every source.
    pub const ALL: [FrictionSource; 2] = [FrictionSource::CONFIGURED, FrictionSource::TWIN];

    /// Every name, for error texts.
    pub const KNOWN: &str = "configured, twin";

    /// The name on the wire; `None` for a code that is no source.
    pub fn name(self) -> Option<&'static str> {
        match self {
            FrictionSource::CONFIGURED => Some("configured"),
            FrictionSource::TWIN => Some("twin"),
            _ => None,
        }
    }

    /// The source of that name.
    pub fn from_name(name: &str) -> Option<FrictionSource> {
        FrictionSource::ALL
            .into_iter()
            .find(|known| known.name() == Some(name))
    }
}

/// The friction that the servo feeds forward at one joint.
/// `ferntast_msgs/msg/FrictionStatus` on the wire.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct FrictionStatusSample {
    /// When it was told.
    pub stamp: Time,
    /// Names of the parameters, as in the arm's file; those after `count` are empty.
    pub names: [Text<24>; MOST_PARAMETERS],
    /// Values by the arm's file.
    pub configured: Numbers,
    /// Values in use now.
    pub values: Numbers,
    /// What the values are, or are on their way to.
    pub targets: Numbers,
    /// Commands dealt with since the start.
    pub commands: u64,
    /// Why the last one was refused; empty where it was not.
    pub refused: Text<96>,
    /// Parameters in the lists.
    pub count: u32,
    /// Which joint, from 0.
    pub joint: u8,
    /// Where the targets come from.
    pub source: FrictionSource,
    /// Keeps the layout free of implicit padding.
    pub reserved: [u8; 2],
}

checks::no_padding!(
    FrictionStatusSample: Time, [Text<24>; MOST_PARAMETERS], Numbers, Numbers, Numbers, u64,
    Text<96>, u32, u8, FrictionSource, [u8; 2]
);

impl FrictionStatusSample {
    /// Joint `joint` (from 0) as configured, of which no parameter is known.
    pub const fn nothing(stamp: Time, joint: u8) -> FrictionStatusSample {
        FrictionStatusSample {
            stamp,
            names: [Text::EMPTY; MOST_PARAMETERS],
            configured: [0.0; MOST_PARAMETERS],
            values: [0.0; MOST_PARAMETERS],
            targets: [0.0; MOST_PARAMETERS],
            commands: 0,
            refused: Text::EMPTY,
            count: 0,
            joint,
            source: FrictionSource::CONFIGURED,
            reserved: [0; 2],
        }
    }

    /// Parameters in the lists, never more than there is room for.
    pub fn len(&self) -> usize {
        (self.count as usize).min(MOST_PARAMETERS)
    }

    /// Whether the lists are empty.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Name of the joint; `None` where there is no such joint.
    pub fn joint_name(&self) -> Option<&'static str> {
        JOINT_NAMES.get(usize::from(self.joint)).copied()
    }
}

// SAFETY: `repr(C)` of integers, floats and byte arrays, transparent types around them, no
// pointer: every bit pattern is a value.
unsafe impl Message for FrictionStatusSample {
    type Ros = FrictionStatus;

    fn stamp(&self) -> Time {
        self.stamp
    }

    fn to_ros(&self) -> FrictionStatus {
        let length = self.len();
        let list = |numbers: &Numbers| numbers.iter().take(length).copied().collect();
        let names = self.names.iter().take(length);
        FrictionStatus {
            header: Header::new(self.stamp, ""),
            joint: checks::wire_name(self.joint_name(), self.joint),
            source: checks::wire_name(self.source.name(), self.source.0),
            names: names.map(|name| name.as_str().to_owned()).collect(),
            configured: list(&self.configured),
            values: list(&self.values),
            targets: list(&self.targets),
            commands: self.commands,
            refused: self.refused.as_str().to_owned(),
        }
    }

    fn from_ros(ros: &FrictionStatus) -> Result<FrictionStatusSample, InvalidMessage> {
        let joint = checks::joint(&ros.joint)?;
        let source = FrictionSource::from_name(&ros.source)
            .ok_or_else(|| checks::unknown("source", &ros.source, FrictionSource::KNOWN))?;
        let count = ros.names.len();
        lists::count(count)?;
        let mut sample = FrictionStatusSample {
            configured: lists::numbers("configured", &ros.configured, count)?,
            values: lists::numbers("values", &ros.values, count)?,
            targets: lists::numbers("targets", &ros.targets, count)?,
            commands: ros.commands,
            refused: Text::new(&ros.refused),
            count: count as u32,
            source,
            ..FrictionStatusSample::nothing(ros.header.time(), joint)
        };
        for (place, name) in sample.names.iter_mut().zip(&ros.names) {
            *place = Text::new(name);
        }
        sample.check()?;
        Ok(sample)
    }

    fn check(&self) -> Result<(), InvalidMessage> {
        checks::stamp(self.stamp)?;
        let count = self.count as usize;
        lists::count(count)?;
        for (field, numbers) in [
            ("configured", &self.configured),
            ("values", &self.values),
            ("targets", &self.targets),
        ] {
            checks::finite(field, &numbers[..count])?;
        }
        checks::code("joint", self.joint_name(), self.joint, checks::KNOWN_JOINTS)?;
        checks::code(
            "source",
            self.source.name(),
            self.source.0,
            FrictionSource::KNOWN,
        )
    }
}
