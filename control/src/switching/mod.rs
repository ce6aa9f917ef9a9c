//! Switching the delay law while the link runs, without a jump in force.
//!
//! The leader's end begins: it goes on feeling by the old law and sends packets
//! of the new one, marked in each frame by the law's code ([`NAMES`]). The
//! follower's end changes over with the first such frame, answers in the new
//! law, and leads its tip command over from the old one. With the first answer
//! the leader's end leads the force over. Neither end is ever without packets
//! of the law by which it acts.
//!
//! Led over is linearly, within [`SWITCH_TIME`], from the last force (command)
//! of the old law: F = (1 − s) F_old + s F_new, s = t/[`SWITCH_TIME`]. A further wish waits until the switch is done; so all
//! frames of a law left before are older than the newest one, and are dropped
//! as late.
//!
//! A law starts over with each switch, its energies at zero. What a law claims
//! about passivity it claims from the end of the switch on: for
//! [`SWITCH_TIME`] the force in the hand is that of neither law.

mod follower;
mod laws;
mod leader;
#[cfg(test)]
mod tests;

pub use follower::{FollowerSwitch, FollowerSwitchOutput};
pub use laws::{Laws, NAMES, code};
pub use leader::{LeaderSwitch, LeaderSwitchOutput};

use crate::delay::{Packet, Received};

/// Within which force and tip command are led over \[s\].
pub const SWITCH_TIME: f64 = 0.3;

/// The newest packet, and which law made it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarkedPacket {
    /// Code of the law.
    pub law: u8,
    /// The packet.
    pub received: Received,
}

impl MarkedPacket {
    /// The packet, if it is of the law of this code.
    fn of(packet: Option<MarkedPacket>, law: u8) -> Option<Received> {
        packet.filter(|own| own.law == law).map(|own| own.received)
    }
}

/// A packet to send, and which law made it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outgoing {
    /// Code of the law.
    pub law: u8,
    /// The packet.
    pub packet: Packet,
}

/// (1 − share) a + share b.
fn between(share: f64, a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| (1.0 - share) * a[axis] + share * b[axis])
}
