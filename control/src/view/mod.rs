//! What the arm's end shows of its arm over the link, for people: where it is and what it touches, and
//! why it is in the state in which it is. Nothing acts on it: the delay laws have their frames
//! ([`crate::frame`]).
//!
//! A view goes 25 times a second ([`ViewSender`]), in bytes of its own ([`encode`]).

mod bytes;
mod ends;
#[cfg(test)]
mod tests;

pub use bytes::{LONGEST_REASON, LONGEST_VIEW, ViewBytes, decode, encode};
pub use ends::{VIEW_PERIOD_NS, ViewReceiver, ViewSender};

use crate::operating::OperatingState;
use crate::short_bytes::ShortBytes;
use ferntast_model::Joints;

/// What a view shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum View {
    /// Where the arm is.
    Arm(ArmView),
    /// Why it is in its state.
    Reason(Reason),
}

/// The arm, as it is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmView {
    /// Joint positions \[rad\], \[m\] of a prismatic joint.
    pub joints: Joints<f32>,
    /// Position of the tip, arm's base frame \[m\].
    pub tip: [f32; 3],
    /// Force of the contact on the tip, arm's base frame \[N\].
    pub force: [f32; 3],
    /// The contact.
    pub contact: ContactView,
}

/// The contact, as it is shown: as the estimator tells of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactView {
    /// The tip touches a known surface.
    pub in_contact: bool,
    /// The tip touches something.
    pub touches: bool,
    /// The forces can be used.
    pub valid: bool,
    /// The motor turns, the tip still rests.
    pub near_rest: bool,
    /// Which surface, by the estimator's code.
    pub edge: u8,
    /// Normal and tangential force \[N\].
    pub forces: [f32; 2],
}

/// Why the arm is in its state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reason {
    /// The state.
    pub state: OperatingState,
    /// Why, UTF-8.
    text: ShortBytes<LONGEST_REASON>,
}

impl Reason {
    /// A state and why; what is longer than a view has room for is cut.
    pub fn new(state: OperatingState, text: &str) -> Reason {
        let text = &text[..text.floor_char_boundary(LONGEST_REASON)];
        let mut bytes = [0; LONGEST_REASON];
        bytes[..text.len()].copy_from_slice(text.as_bytes());
        let text = ShortBytes::new(bytes, text.len());
        Reason { state, text }
    }

    /// Why.
    pub fn text(&self) -> &str {
        // It was made of a text.
        str::from_utf8(&self.text).unwrap_or_default()
    }
}

/// A view, as it came over the link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SentView {
    /// One more with every view sent; wraps.
    pub number: u32,
    /// When it was sent, by the clock of whoever has it, as far as it knows the sender's
    /// \[ns since the UNIX epoch\].
    pub sent_ns: i64,
    /// What it shows.
    pub view: View,
}

/// Why a view was refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ViewError {
    /// No view has so many bytes, or not with the number of joints that it says.
    #[error(
        "a view of the arm of {found} bytes that says {joints} joints; is the peer another program?"
    )]
    Length {
        /// Bytes received.
        found: usize,
        /// Joints that it says.
        joints: usize,
    },
    /// Not finite or out of range.
    #[error("{field} in the view of the arm is {value}, not within ±{limit}")]
    Value {
        /// Which field.
        field: &'static str,
        /// What it holds.
        value: f32,
        /// Largest magnitude allowed.
        limit: f32,
    },
    /// No text, or one with what is not to be printed.
    #[error("what the arm's end says of its state is no text")]
    Text,
}
