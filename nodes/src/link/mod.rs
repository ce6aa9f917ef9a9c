//! The two ends of the link as nodes.
//!
//! Motion goes forward, force comes back, in frames of 60 bytes at 500 Hz. What an
//! end does is in [`ferntast_control::link`]; here are its topics. Frames come in through the channel emulator ([`transport`]), whose way out
//! is the moment of arrival.

mod follower;
mod leader;
mod status;
#[cfg(test)]
mod tests;
pub mod transport;

pub use follower::{FollowerLinkInput, FollowerLinkNode, FollowerLinkOutput, FollowerLinkPorts};
pub use leader::{LeaderLinkInput, LeaderLinkNode, LeaderLinkOutput, LeaderLinkPorts};
pub use transport::{FrameInput, FrameOutput, LinkPorts, LinkTransport};

use ferntast_control::{link::StampedPosition, operating::OperatingState};
use ferntast_msgs::{
    Time,
    sample::{OperatingStateSample, PoseSample},
};

use crate::node::Newest;

/// A pose as the ends take it.
fn position(now: Time, pose: &Newest<PoseSample>) -> Option<StampedPosition> {
    pose.message.map(|own| StampedPosition {
        stamp_ns: own.stamp.nanos(),
        position: own.position,
        silence: pose.silence(now),
    })
}

/// The state of an end's device; disabled as long as it says nothing.
fn operating_state(state: &Newest<OperatingStateSample>) -> OperatingState {
    state
        .message
        .and_then(|sample| OperatingState::from_code(sample.state.0))
        .unwrap_or(OperatingState::Disabled)
}

/// Identity of a session in frames: a hash (FNV-1a, folded) of its name.
pub fn session_number(name: &str) -> u16 {
    let hash = name.bytes().fold(0x811c_9dc5_u32, |hash, byte| {
        (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193)
    });
    (hash >> 16) as u16 ^ hash as u16
}
