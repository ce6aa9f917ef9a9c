//! What goes over the wire: five kinds of messages, told by their first byte.
//!
//! | kind | content | bytes |
//! |---|---|---:|
//! | frame | see [`frame`](crate::frame) | 60; 68 with an orientation; 29 of a keep-alive |
//! | view | what the arm's end shows of its arm, sealed as a frame is | up to 116 |
//! | hello | kind: the operator's end asks for a challenge | 1 |
//! | challenge | kind, 8 random bytes of the arm's end | 9 |
//! | initiation | kind, the challenge, first message of Noise | 113 |
//! | answer | kind, the challenge, second message of Noise | 73 |
//!
//! Bits 4–7 of the first byte are the version of all that, bits 0–3 the kind.

/// Version of the format.
pub const VERSION: u8 = 5;
/// Longest message of a handshake \[bytes\].
pub const LONGEST_MESSAGE: usize = 128;

pub(crate) const FRAME: u8 = 0;
pub(crate) const HELLO: u8 = 1;
pub(crate) const CHALLENGE: u8 = 2;
pub(crate) const INITIATION: u8 = 3;
pub(crate) const ANSWER: u8 = 4;
pub(crate) const VIEW: u8 = 5;

/// The challenge that a handshake is for: what is played again is for another.
pub(crate) type Challenge = [u8; 8];

/// The first byte of a message of this kind.
pub(crate) const fn first_byte(kind: u8) -> u8 {
    VERSION << 4 | kind
}

/// A message of the handshake, in place.
#[derive(Clone, Copy, Debug)]
pub struct Message {
    bytes: [u8; LONGEST_MESSAGE],
    length: usize,
}

impl Message {
    pub(crate) fn of(kind: u8) -> Message {
        let mut bytes = [0; LONGEST_MESSAGE];
        bytes[0] = first_byte(kind);
        Message { bytes, length: 1 }
    }

    pub(crate) fn with_challenge(kind: u8, challenge: &Challenge) -> Message {
        let mut message = Message::of(kind);
        message.bytes[1..9].copy_from_slice(challenge);
        message.length = 9;
        message
    }

    /// Lets `write` append to it; it gives the number of bytes.
    pub(crate) fn append<E>(
        mut self,
        write: impl FnOnce(&mut [u8]) -> Result<usize, E>,
    ) -> Result<Message, E> {
        let room = &mut self.bytes[self.length..];
        let most = room.len();
        self.length += write(room)?.min(most);
        Ok(self)
    }

    /// As it goes over the wire.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes[..self.length]
    }
}

/// Challenge and rest of an initiation or answer.
pub(crate) fn parts(bytes: &[u8]) -> Option<(Challenge, &[u8])> {
    let (challenge, rest) = bytes.get(1..)?.split_first_chunk::<8>()?;
    Some((*challenge, rest))
}
