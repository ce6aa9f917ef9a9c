//! `ferntast_msgs/msg/LinkStatus`.

use serde::{Deserialize, Serialize};

use crate::{RosMessage, ros::std_msgs::Header};

/// What one end of the link measures.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LinkStatus {
    /// When it was measured; no frame.
    pub header: Header,
    /// Which end measured it: leader or follower.
    pub end: String,
    /// The delay law.
    pub law: String,
    /// Identity of the session.
    pub session: u16,
    /// Frames arrive.
    pub connected: bool,
    /// Round trip \[s\]; NaN before the first measurement.
    pub round_trip: f64,
    /// One way, the other end to this one \[s\]; NaN before the first.
    pub delay: f64,
    /// Interarrival jitter, RFC 3550 \[s\].
    pub jitter: f64,
    /// Share of frames lost in the last second, 0 … 1.
    pub loss: f64,
    /// Age of the content in use \[s\].
    pub age: f64,
    /// Energy that entered at this end since the start \[J\].
    pub energy_in: f64,
    /// Energy that left at this end since the start \[J\].
    pub energy_out: f64,
    /// Energy dissipated by the law since the start \[J\].
    pub energy_dissipated: f64,
    /// Frames sent.
    pub sent: u64,
    /// Frames received and acted on.
    pub received: u64,
    /// Frames lost.
    pub lost: u64,
    /// Refused: not as long as a frame is.
    pub refused_length: u64,
    /// Refused: of another version of the format.
    pub refused_version: u64,
    /// Refused: of another session.
    pub refused_session: u64,
    /// Refused: checksum wrong.
    pub refused_checksum: u64,
    /// Refused: sent in the future, or longer ago than a frame can live.
    pub refused_time: u64,
    /// Refused: a number that is not finite or out of range.
    pub refused_value: u64,
    /// Refused: a sequence number that was acted on before.
    pub refused_replayed: u64,
    /// Refused: overtaken by a newer frame.
    pub refused_late: u64,
}

impl RosMessage for LinkStatus {
    const INTERFACE: &'static str = "ferntast_msgs/msg/LinkStatus";
}
