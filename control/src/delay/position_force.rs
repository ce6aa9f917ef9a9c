//! Position forward, force back, hold on loss.
//!
//! x_d = x_0 + s_x x_h(t − T₁) and F_h = s_F F_e(t − T₂): the two-channel
//! "position–force" architecture (Lawrence 1993, "Stability and transparency
//! in bilateral teleoperation", section III; Hokayem and Spong 2006, "Bilateral
//! teleoperation: an historical survey", section 2). Here x_h is the hand, x_d
//! the tip command, F_e the contact's force on the tip.
//!
//! **On loss.** The follower's end gives a command for each packet that comes
//! in and none otherwise, so the servo's watchdog pauses the arm. The leader's
//! end lets the force ramp to zero. Of what queued up during an outage only
//! the newest counts, and the way back from the hold is the servo's ramp.
//!
//! **What it guarantees.** Nothing about stability. The loop is hand – delay –
//! contact – delay: with contact stiffness k_e, scale s = s_x s_F, a hand of
//! mass m, damping b and stiffness k, the force comes back as s k_e x(t − T). It
//! is stable for every delay only if s k_e is below what the hand gives at every
//! frequency, min |m(jω)² + b jω + k|; a stiff contact goes unstable beyond
//! some tens of milliseconds. On the simulated arm (contact through servo and
//! gear) with a firm hand (0.5 kg, 50 N·s/m, 1000 N/m) and 20 or 30 ms round
//! trip, pressing is steady up to a force scale of 0.1 and bounces at 0.15. Transparent without delay and with a stiff servo.

use super::mapping::{ForceRamp, Mapping, law_ends, law_parameters};
use super::{
    Energy, Follower, FollowerInput, FollowerOutput, Leader, LeaderInput, LeaderOutput, Packet,
    Samples, vector,
};
use nalgebra::Vector3;

law_parameters! {
    /// Parameters of the law. Every key may be left out.
    pub struct PositionForce {}
}
law_ends!(
    PositionForce,
    "position_force",
    Nothing,
    PositionForceLeader,
    PositionForceFollower
);

impl PositionForce {
    fn samples(&self) -> [Samples; 2] {
        [Samples::MOTION, Samples::force(self.force_scale)]
    }
}

/// The leader's end: sends position and velocity \[m/s\] of the hand.
#[derive(Clone, Debug)]
pub struct PositionForceLeader {
    mapping: Mapping,
    fade: ForceRamp,
    /// The newest force received, scaled [N].
    force: Vector3<f64>,
}

impl PositionForceLeader {
    fn new(law: &PositionForce) -> Self {
        PositionForceLeader {
            mapping: law.mapping(),
            fade: ForceRamp::default(),
            force: Vector3::zeros(),
        }
    }
}

impl Leader for PositionForceLeader {
    fn step(&mut self, dt: f64, input: &LeaderInput, energy: Energy) -> LeaderOutput {
        let live = self.mapping.live(input.connected, input.received);
        if let Some(received) = live {
            self.force = self.mapping.force_scale * vector(received.packet.vector);
        }
        let share = self.fade.step(dt, self.mapping.force_ramp, live.is_some());
        LeaderOutput {
            force: (share * self.force).into(),
            packet: input.hand.map_or(Packet::empty(energy), |hand| {
                Packet::new(hand.position, hand.velocity, energy)
            }),
        }
    }
}

/// The follower's end: sends position of the tip and force of the contact on
/// it \[N\].
#[derive(Clone, Debug)]
pub struct PositionForceFollower {
    mapping: Mapping,
}

impl PositionForceFollower {
    fn new(law: &PositionForce) -> Self {
        PositionForceFollower {
            mapping: law.mapping(),
        }
    }
}

impl Follower for PositionForceFollower {
    fn step(&mut self, _dt: f64, input: &FollowerInput, energy: Energy) -> FollowerOutput {
        let command = self
            .mapping
            .live(input.connected, input.received)
            .filter(|received| received.fresh)
            .map(|received| {
                let packet = received.packet;
                self.mapping
                    .command(vector(packet.position), vector(packet.vector))
            });
        let packet = match (input.tip, input.contact_force) {
            (Some(tip), Some(force)) => Packet::new(tip.position, force, energy),
            _ => Packet::empty(energy),
        };
        FollowerOutput { command, packet }
    }
}

#[cfg(test)]
mod tests;
