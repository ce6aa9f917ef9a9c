//! Keeps the frames of the link from strangers.
//!
//! Each host has a key pair, as with `ssh` and WireGuard ([`keys`]): the operator's
//! end knows the public key of the arm's end, the arm's end knows whom it obeys. (The
//! same pair is what a host's certificate for TLS is made of, outside.)
//! A handshake ([`handshake`], Noise IK) proves both and gives two keys, one a
//! direction, that live as long as both processes: whatever is started anew has
//! other keys, so that a frame from before means nothing. Frames are sealed with
//! them ([`frame`], AES-256-CCM with a tag of 8 bytes) and counted, and no count is
//! taken twice ([`window`]). [`SecureEnd`] is one end of that.
//!
//! Pure: time and randomness are arguments, bytes go in and come out. A handshake
//! allocates, sealed frames do not.

mod end;
pub mod frame;
mod handshake;
pub mod keys;
mod refusal;
mod window;
mod wire;

pub use end::{Established, Received, Role, SecureEnd};
pub use frame::{
    FrameBytes, Kind, LONG_LENGTH, LONGEST_VIEW, PLAIN_LENGTH, PlainFrame, SEALED_LENGTH,
    SHORT_LENGTH, SealedFrame,
};
pub use keys::{ExchangeKey, KEY_LENGTH, KeyError, PrivateKey, PublicKey};
pub use refusal::{Refusal, RefusalCounts};
pub use wire::{LONGEST_MESSAGE, Message};
