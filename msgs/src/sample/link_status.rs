//! What one end of the link measures.

use crate::{
    InvalidMessage, Message, Text, Time,
    ros::{ferntast_msgs::LinkStatus, std_msgs::Header},
};

use super::checks;

/// An end of the link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(transparent)]
pub struct LinkEnd(pub u8);

impl LinkEnd {
    /// The operator's end.
    pub const LEADER: LinkEnd = LinkEnd(0);
    /// The arm's end.
    pub const FOLLOWER: LinkEnd = LinkEnd(1);

    /// Every end.
    pub const ALL: [LinkEnd; 2] = [LinkEnd::LEADER, LinkEnd::FOLLOWER];

    /// Every name, for error texts.
    pub const KNOWN: &str = "leader, follower";

    /// The name on the wire; `None` for a code that is no end.
    pub fn name(self) -> Option<&'static str> {
        match self {
            LinkEnd::LEADER => Some("leader"),
            LinkEnd::FOLLOWER => Some("follower"),
            _ => None,
        }
    }

    /// The end of that name.
    pub fn from_name(name: &str) -> Option<LinkEnd> {
        LinkEnd::ALL
            .into_iter()
            .find(|known| known.name() == Some(name))
    }
}

/// Received frames that were not acted on, by kind (counts since the start).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct RefusedFrames {
    /// Not as long as a frame is.
    pub length: u64,
    /// Of another version of the format.
    pub version: u64,
    /// Of another session.
    pub session: u64,
    /// Checksum wrong.
    pub checksum: u64,
    /// Sent in the future, or longer ago than a frame can live.
    pub time: u64,
    /// A number that is not finite or out of range.
    pub value: u64,
    /// A sequence number that was acted on before.
    pub replayed: u64,
    /// Overtaken by a newer frame.
    pub late: u64,
}

/// What one end of the link measures of it, never what was configured.
/// `ferntast_msgs/msg/LinkStatus` on the wire.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct LinkStatusSample {
    /// When it was measured.
    pub stamp: Time,
    /// Round trip \[s\]: newest measurement; NaN before the first.
    pub round_trip: f64,
    /// One way, the other end to this one \[s\]; true as far as both clocks agree; NaN before the first.
    pub delay: f64,
    /// Interarrival jitter after RFC 3550, section 6.4.1 \[s\].
    pub jitter: f64,
    /// Share of the frames sent to this end in the last second that did not arrive, 0 … 1.
    pub loss: f64,
    /// Age of the content in use \[s\].
    pub age: f64,
    /// Energy that entered the two-port at this end since the start \[J\].
    pub energy_in: f64,
    /// Energy that left the two-port at this end since the start \[J\].
    pub energy_out: f64,
    /// Energy that the law dissipated at this end since the start \[J\].
    pub energy_dissipated: f64,
    /// Frames sent since the start.
    pub sent: u64,
    /// Frames received and acted on since the start.
    pub received: u64,
    /// Frames lost since the start.
    pub lost: u64,
    /// Frames received and not acted on.
    pub refused: RefusedFrames,
    /// The delay law.
    pub law: Text<24>,
    /// Identity of the session.
    pub session: u16,
    /// Which end measured it.
    pub end: LinkEnd,
    /// 1 while frames arrive.
    pub connected: u8,
    /// Keeps the layout free of implicit padding.
    pub reserved: [u8; 4],
}

checks::no_padding!(
    RefusedFrames: u64, u64, u64, u64, u64, u64, u64, u64
);
checks::no_padding!(
    LinkStatusSample: Time, f64, f64, f64, f64, f64, f64, f64, f64, u64, u64, u64,
    RefusedFrames, Text<24>, u16, LinkEnd, u8, [u8; 4]
);

impl LinkStatusSample {
    /// A link on which nothing has happened yet.
    pub const fn idle(stamp: Time, end: LinkEnd) -> LinkStatusSample {
        LinkStatusSample {
            stamp,
            round_trip: f64::NAN,
            delay: f64::NAN,
            jitter: 0.0,
            loss: 0.0,
            age: 0.0,
            energy_in: 0.0,
            energy_out: 0.0,
            energy_dissipated: 0.0,
            sent: 0,
            received: 0,
            lost: 0,
            refused: RefusedFrames {
                length: 0,
                version: 0,
                session: 0,
                checksum: 0,
                time: 0,
                value: 0,
                replayed: 0,
                late: 0,
            },
            law: Text::EMPTY,
            session: 0,
            end,
            connected: 0,
            reserved: [0; 4],
        }
    }
}

// SAFETY: `repr(C)` of integers, floats and byte arrays, transparent types around them, no
// pointer: every bit pattern is a value.
unsafe impl Message for LinkStatusSample {
    type Ros = LinkStatus;

    fn stamp(&self) -> Time {
        self.stamp
    }

    fn to_ros(&self) -> LinkStatus {
        LinkStatus {
            header: Header::new(self.stamp, ""),
            end: checks::wire_name(self.end.name(), self.end.0),
            law: self.law.as_str().to_owned(),
            session: self.session,
            connected: self.connected != 0,
            round_trip: self.round_trip,
            delay: self.delay,
            jitter: self.jitter,
            loss: self.loss,
            age: self.age,
            energy_in: self.energy_in,
            energy_out: self.energy_out,
            energy_dissipated: self.energy_dissipated,
            sent: self.sent,
            received: self.received,
            lost: self.lost,
            refused_length: self.refused.length,
            refused_version: self.refused.version,
            refused_session: self.refused.session,
            refused_checksum: self.refused.checksum,
            refused_time: self.refused.time,
            refused_value: self.refused.value,
            refused_replayed: self.refused.replayed,
            refused_late: self.refused.late,
        }
    }

    fn from_ros(ros: &LinkStatus) -> Result<LinkStatusSample, InvalidMessage> {
        let end = LinkEnd::from_name(&ros.end)
            .ok_or_else(|| checks::unknown("end", &ros.end, LinkEnd::KNOWN))?;
        let sample = LinkStatusSample {
            stamp: ros.header.time(),
            round_trip: ros.round_trip,
            delay: ros.delay,
            jitter: ros.jitter,
            loss: ros.loss,
            age: ros.age,
            energy_in: ros.energy_in,
            energy_out: ros.energy_out,
            energy_dissipated: ros.energy_dissipated,
            sent: ros.sent,
            received: ros.received,
            lost: ros.lost,
            refused: RefusedFrames {
                length: ros.refused_length,
                version: ros.refused_version,
                session: ros.refused_session,
                checksum: ros.refused_checksum,
                time: ros.refused_time,
                value: ros.refused_value,
                replayed: ros.refused_replayed,
                late: ros.refused_late,
            },
            law: Text::new(&ros.law),
            session: ros.session,
            end,
            connected: ros.connected.into(),
            reserved: [0; 4],
        };
        sample.check()?;
        Ok(sample)
    }

    /// NaN is valid for round trip and delay: not measured yet.
    fn check(&self) -> Result<(), InvalidMessage> {
        checks::stamp(self.stamp)?;
        checks::finite_or_nan("round_trip", self.round_trip)?;
        checks::finite_or_nan("delay", self.delay)?;
        checks::finite("jitter", &[self.jitter])?;
        checks::finite("loss", &[self.loss])?;
        checks::finite("age", &[self.age])?;
        checks::finite("energy_in", &[self.energy_in])?;
        checks::finite("energy_out", &[self.energy_out])?;
        checks::finite("energy_dissipated", &[self.energy_dissipated])?;
        checks::flag("connected", self.connected)?;
        checks::code("end", self.end.name(), self.end.0, LinkEnd::KNOWN)
    }
}
