//! The two ends of the link: bytes of frames in, bytes of frames out, and
//! between them the delay law.
//!
//! What arrives is decoded, measured ([`LinkMeter`](crate::meter::LinkMeter)) and played
//! out ([`PlayOut`](crate::playout::PlayOut)); the law of the end acts on the
//! frame that is played out and makes the packet of the next one. The nodes of a
//! session, the lockstep executor and the trials of a sweep run these ends and
//! no others; what lies between the ends, a wire or an emulated channel, is not
//! theirs.
//!
//! Times are `i64` nanoseconds since the UNIX epoch. An end allocates when it is
//! made, never afterwards.

mod end;
mod follower;
mod leader;
#[cfg(test)]
mod tests;
mod velocity;

pub use follower::{ESTIMATE_LIFE, FollowerLink, FollowerReadings, FollowerStep};
pub use leader::{HAND_LIFE, LeaderLink, LeaderReadings, LeaderStep};

use crate::delay::Energy;
use crate::meter::LinkMeasurement;

/// Time between two frames \[ns\]: 500 Hz.
pub const SEND_PERIOD_NS: i64 = 2_000_000;
/// The other end counts as connected while its newest frame is younger than
/// this \[s\].
pub const CONNECTED: f64 = 0.100;

/// A measured position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StampedPosition {
    /// When it was measured \[ns\].
    pub stamp_ns: i64,
    /// \[m\]
    pub position: [f64; 3],
    /// Time since it was received \[s\].
    pub silence: f64,
}

/// What an end knows of the link and of its law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkState {
    /// Frames from the other end arrive.
    pub connected: bool,
    /// Of the link; frames that came too late to be played out count as late.
    pub measured: LinkMeasurement,
    /// Name of the law in force.
    pub law: &'static str,
    /// At the port of this end.
    pub energy: Energy,
    /// By the laws at this end \[J\].
    pub dissipated: f64,
}
