//! What is not acted on, and why.

use crate::{keys::ExchangeKey, wire::VERSION};

/// Why bytes that came in are not acted on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Refusal {
    /// No kind of message has so many bytes.
    #[error("a message of {found} bytes is none of the link's; is the peer another program?")]
    Length {
        /// Bytes received.
        found: usize,
    },
    /// Another version of the format.
    #[error(
        "the peer speaks version {found} of the link, this end {VERSION}; run the same version at both ends"
    )]
    Version {
        /// In the message.
        found: u8,
    },
    /// There has been no handshake yet, or the peer's key is one from before it.
    #[error("a frame under no key of this session: from before a restart, or of another sender")]
    UnknownKey,
    /// The tag does not fit: damaged, or made without the key.
    #[error("a frame whose seal is wrong: damaged on the way, or forged")]
    Forged,
    /// This number was taken before, or is too old to be told.
    #[error("a frame that was here before: played again, or long overtaken")]
    Replayed,
    /// A handshake for a challenge that is not open.
    #[error("a handshake that was not asked for: played again, or late")]
    StaleHandshake,
    /// A handshake that cannot be read.
    #[error("a handshake that cannot be read: made for another key or another session, or forged")]
    Handshake,
    /// A handshake of a host that is not known here.
    #[error(
        "host {0}… is not known here: if it may operate this arm, run 'ferntast link keys add NAME KEY', \
         with the key beginning so that 'ferntast link keys show' says there"
    )]
    UnknownPeer(ExchangeKey),
    /// A handshake while the peer in force is heard.
    #[error("a handshake while another process operates this arm: end that one first")]
    Taken,
    /// A message that only the other side sends.
    #[error("a message that only the other side sends: reflected, or two ends of one kind")]
    WrongSide,
}

/// What was not acted on, by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RefusalCounts {
    /// Not as long as a message is.
    pub length: u64,
    /// Of another version.
    pub version: u64,
    /// Frames under no key of this session.
    pub unknown_key: u64,
    /// Frames whose seal is wrong.
    pub forged: u64,
    /// Frames that were here before.
    pub replayed: u64,
    /// Handshakes: not asked for, not readable, of strangers.
    pub handshake: u64,
}

impl RefusalCounts {
    /// Counts `refusal`.
    pub fn count(&mut self, refusal: &Refusal) {
        let counter = match refusal {
            Refusal::Length { .. } => &mut self.length,
            Refusal::Version { .. } => &mut self.version,
            Refusal::UnknownKey => &mut self.unknown_key,
            Refusal::Forged => &mut self.forged,
            Refusal::Replayed => &mut self.replayed,
            Refusal::StaleHandshake
            | Refusal::Handshake
            | Refusal::UnknownPeer(_)
            | Refusal::Taken
            | Refusal::WrongSide => &mut self.handshake,
        };
        *counter += 1;
    }

    /// All of them.
    pub fn total(&self) -> u64 {
        self.length + self.version + self.unknown_key + self.forged + self.replayed + self.handshake
    }
}
