//! The two ends of the link as nodes.
//!
//! Motion goes forward, force comes back, in frames of 60 bytes at 500 Hz.
//! Frames come in through the channel emulator ([`transport`]), whose way out
//! is the moment of arrival.

mod end;
mod follower;
mod leader;
#[cfg(test)]
mod tests;
pub mod transport;
mod velocity;

pub use follower::{FollowerLinkInput, FollowerLinkNode, FollowerLinkOutput, FollowerLinkPorts};
pub use leader::{LeaderLinkInput, LeaderLinkNode, LeaderLinkOutput, LeaderLinkPorts};
pub use transport::{FrameInput, FrameOutput, LinkPorts, LinkTransport};

/// Identity of a session in frames: a hash (FNV-1a, folded) of its name.
pub fn session_number(name: &str) -> u16 {
    let hash = name.bytes().fold(0x811c_9dc5_u32, |hash, byte| {
        (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193)
    });
    (hash >> 16) as u16 ^ hash as u16
}
