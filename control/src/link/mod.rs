//! The two ends of the link: bytes of frames in, bytes of frames out, and
//! between them the delay law.
//!
//! What arrives is decoded, measured ([`LinkMeter`](crate::meter::LinkMeter)) and played
//! out ([`PlayOut`](crate::playout::PlayOut)); the law of the end acts on the
//! frame that is played out and makes the packet of the next one. The nodes of a
//! session, the lockstep executor and the trials of a sweep run these ends and
//! no others; what lies between the ends, a wire or an emulated channel, is not
//! theirs. Frames come opened and go to be sealed (crate `ferntast-seal`): whoever
//! holds the keys tells the end when another process is at the other one
//! ([`LeaderLink::peer_changed`], [`FollowerLink::peer_changed`]).
//!
//! Beside its frames the arm's end may show its arm ([`crate::view`]), for people.
//!
//! An end may leave out frames that say nothing new ([`crate::codec`]), and each understands one
//! that does.
//!
//! **When the arm is commanded.** A command is stamped with when what it rests on came
//! in, [`FRESH`] later at most: a law may go on for some milliseconds without frames,
//! but the servo's watchdog counts from the link's silence and refuses what is too
//! old. An end that hears nothing for
//! [`RETURN_SILENCE`] (with a jitter buffer: that had nothing to play out, so the buffer's
//! length later), or whose device is not ENABLED, asks the other to hold: the
//! arm's end then commands nothing either, and the hand's force fades out, at once or, where the
//! law renders a model of what was touched, after that has outlived the arm
//! (`outlives`, [`crate::delay::ModelMediated`]).
//!
//! Times are `i64` nanoseconds since the UNIX epoch. An end allocates when it is
//! made, never afterwards.

mod end;
mod follower;
mod gap;
mod leader;
#[cfg(test)]
mod pair_tests;
#[cfg(test)]
mod tests;
mod velocity;
mod word;

pub use follower::{ESTIMATE_LIFE, FollowerLink, FollowerReadings, FollowerStep};
pub use leader::{LeaderLink, LeaderReadings, LeaderStep};
pub use velocity::{LONGEST_LIFE as LONGEST_HAND_LIFE, SHORTEST_LIFE as SHORTEST_HAND_LIFE};
pub use word::Word;

pub use crate::frame::SEND_PERIOD_NS;

use crate::codec::Traffic;
use crate::delay::Energy;
use crate::meter::LinkMeasurement;
use crate::operating::OperatingState;

/// The other end counts as connected while it was heard, or a frame of it played out, no
/// longer ago than this \[s\].
pub const CONNECTED: f64 = 0.100;

/// A command counts as made this long after the newest frame at most \[s\]: half a period
/// of frames.
pub const FRESH: f64 = 0.001;
/// An end that has heard nothing for this long asks the other to hold \[s\].
pub const RETURN_SILENCE: f64 = 0.025;
/// The operator's word to arm again counts only when no gap before it was longer
/// \[s\]: what was said to a link that was away is not fresh when it comes back.
pub const WORD_LIFE: f64 = 0.5;

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
    /// The other end asks this one to hold.
    pub held: bool,
    /// State of the other end's device; DISABLED as long as nothing was heard.
    pub peer: OperatingState,
    /// Of the link; frames that came too late to be played out count as late.
    pub measured: LinkMeasurement,
    /// Name of the law in force.
    pub law: &'static str,
    /// At the port of this end.
    pub energy: Energy,
    /// By the laws at this end \[J\].
    pub dissipated: f64,
    /// What this end sent.
    pub traffic: Traffic,
}
