//! The two ends of the link as nodes.
//!
//! Motion goes forward, force comes back, in frames of 60 bytes at 500 Hz or fewer, sealed
//! ([`ferntast_seal`]); of 68 bytes where a hand's orientation goes along. What an end does is in [`ferntast_control::link`]; here are its
//! topics. Where the ends are on two hosts, the arm's end shows its arm beside them
//! ([`ferntast_control::view`]). Frames come in through the channel emulator ([`transport`]), whose way
//! out is the moment of arrival.

mod follower;
mod leader;
mod readings;
mod status;
#[cfg(test)]
mod tests;
pub mod transport;

use ferntast_bus::frames::LinkDirection;
use ferntast_control::link::{FollowerLink, LeaderLink};

use crate::{
    graph::Build,
    node::Ticking,
    process::{End, NodeError},
};

pub use follower::{FollowerLinkInput, FollowerLinkNode, FollowerLinkOutput, FollowerLinkPorts};
pub use leader::{LeaderLinkInput, LeaderLinkNode, LeaderLinkOutput, LeaderLinkPorts};
pub use transport::{FrameInput, FrameOutput, LinkPorts, LinkTransport, LinkWire, Peer};

/// Node at the operator's end.
pub const LEADER: &str = "link_leader";
/// Node at the arm's end.
pub const FOLLOWER: &str = "link_follower";

/// The operator's end, a node of the graph.
///
/// # Errors
///
/// The link or a topic cannot be opened; a parameter of the channel is out of
/// its bounds.
pub fn make_leader(build: Build) -> Result<Box<dyn Ticking>, NodeError> {
    let loaded = &build.session.loaded;
    let session = session_number(&build.session.session);
    let link = &loaded.scenario.link;
    let end = LeaderLink::new(loaded.laws(), link.buffer).coded(link.codec.of(link.deadband));
    let joints = build.session.joints();
    let node = LeaderLinkNode::new(end, session, joints, loaded.arm.model.turns_tool());
    let wire = (build.open_link)(LinkDirection::Forward)?;
    let seed = loaded.scenario.seed.wrapping_add(2);
    let transport = LinkTransport::new(wire, loaded.link.down.clone(), seed)?;
    let ports = LinkPorts::new(LeaderLinkPorts::connect(build.bus, &joints)?, transport);
    build.join(node, ports)
}

/// The arm's end, a node of the graph.
///
/// # Errors
///
/// As [`make_leader`].
pub fn make_follower(build: Build) -> Result<Box<dyn Ticking>, NodeError> {
    let loaded = &build.session.loaded;
    let session = session_number(&build.session.session);
    let link = &loaded.scenario.link;
    let end = FollowerLink::new(loaded.laws(), link.buffer)
        .coded(link.codec.of(link.deadband))
        .bridging(link.rearm_after_gap)
        .planted(build.session.planted);
    let node = FollowerLinkNode::new(end, session);
    let node = match build.session.end {
        // Who has the hand is on another host.
        Some(End::Arm) => node.showing(),
        Some(End::Operator) | None => node,
    };
    let wire = (build.open_link)(LinkDirection::Back)?;
    let seed = loaded.scenario.seed.wrapping_add(1);
    let transport = LinkTransport::new(wire, loaded.link.up.clone(), seed)?;
    let ports = LinkPorts::new(
        FollowerLinkPorts::connect(build.bus, &build.session.joints())?,
        transport,
    );
    build.join(node, ports)
}

/// Number of a session in the status of its link: a hash (FNV-1a, folded) of its name.
pub fn session_number(name: &str) -> u16 {
    let hash = name.bytes().fold(0x811c_9dc5_u32, |hash, byte| {
        (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193)
    });
    (hash >> 16) as u16 ^ hash as u16
}
