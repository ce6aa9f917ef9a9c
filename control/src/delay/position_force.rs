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

use super::{Follower, FollowerInput, FollowerOutput, Leader, LeaderInput, LeaderOutput, Packet};
use crate::delay::Motion;
use crate::frame::{POSITION_LIMIT, VECTOR_LIMIT};
use ferntast_model::{ParameterError, check};
use serde::{Deserialize, Serialize};

/// Parameters of the law. Every key may be left out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PositionForce {
    /// s_x: motion of the tip by motion of the hand \[-\].
    pub position_scale: f64,
    /// s_F: force on the hand by force on the tip \[-\].
    pub force_scale: f64,
    /// x_0: tip position when the hand is in the middle of its workspace,
    /// follower base frame \[m\].
    pub workspace_offset: [f64; 3],
    /// Silence after which the other end counts as lost \[s\].
    pub deadline: f64,
    /// Time in which the force on the hand fades out on loss, and in again \[s\].
    pub force_ramp: f64,
}

impl Default for PositionForce {
    fn default() -> Self {
        PositionForce {
            position_scale: 1.0,
            force_scale: 0.05,
            workspace_offset: [0.35355, 0.0, 0.0],
            deadline: 0.025,
            force_ramp: 0.2,
        }
    }
}

impl PositionForce {
    /// Checks every value against its bounds.
    ///
    /// # Errors
    ///
    /// The first value that is out of bounds.
    pub fn validate(&self) -> Result<(), ParameterError> {
        check("position_scale", self.position_scale, 1e-3, 1e3, "-")?;
        check("force_scale", self.force_scale, 0.0, 1e3, "-")?;
        for (axis, value) in self.workspace_offset.iter().enumerate() {
            check(
                &format!("workspace_offset[{axis}]"),
                *value,
                -10.0,
                10.0,
                "m",
            )?;
        }
        check("deadline", self.deadline, 0.002, 0.030, "s")?;
        check("force_ramp", self.force_ramp, 0.001, 10.0, "s")
    }

    /// The leader's end.
    pub fn leader(&self) -> PositionForceLeader {
        PositionForceLeader {
            parameters: self.clone(),
            share: 0.0,
            force: [0.0; 3],
        }
    }

    /// The follower's end.
    pub fn follower(&self) -> PositionForceFollower {
        PositionForceFollower {
            parameters: self.clone(),
        }
    }
}

/// The leader's end: sends position and velocity \[m/s\] of the hand.
#[derive(Clone, Debug)]
pub struct PositionForceLeader {
    parameters: PositionForce,
    /// How far the force is faded in, 0 … 1.
    share: f64,
    /// The newest force received, scaled [N].
    force: [f64; 3],
}

impl Leader for PositionForceLeader {
    fn step(&mut self, dt: f64, input: &LeaderInput) -> LeaderOutput {
        let live = input.received.filter(|received| {
            input.connected && received.packet.valid && received.silence <= self.parameters.deadline
        });
        if let Some(received) = live {
            let scale = self.parameters.force_scale;
            self.force = received.packet.vector.map(|force| scale * f64::from(force));
        }
        let change = dt / self.parameters.force_ramp;
        let change = if live.is_some() { change } else { -change };
        self.share = (self.share + change).clamp(0.0, 1.0);
        LeaderOutput {
            force: self.force.map(|force| self.share * force),
            packet: input.hand.map_or(Packet::default(), |hand| Packet {
                valid: true,
                position: bounded(hand.position, POSITION_LIMIT),
                vector: bounded(hand.velocity, VECTOR_LIMIT),
                ..Packet::default()
            }),
        }
    }
}

/// The follower's end: sends position of the tip and force of the contact on
/// it \[N\].
#[derive(Clone, Debug)]
pub struct PositionForceFollower {
    parameters: PositionForce,
}

impl Follower for PositionForceFollower {
    fn step(&mut self, _dt: f64, input: &FollowerInput) -> FollowerOutput {
        let PositionForce {
            position_scale,
            workspace_offset,
            deadline,
            ..
        } = self.parameters;
        let command = input
            .received
            .filter(|received| {
                let live = input.connected && received.silence <= deadline;
                live && received.fresh && received.packet.valid
            })
            .map(|received| Motion {
                position: std::array::from_fn(|axis| {
                    workspace_offset[axis]
                        + position_scale * f64::from(received.packet.position[axis])
                }),
                velocity: received
                    .packet
                    .vector
                    .map(|velocity| position_scale * f64::from(velocity)),
            });
        let packet = match (input.tip, input.contact_force) {
            (Some(tip), Some(force)) => Packet {
                valid: true,
                position: bounded(tip.position, POSITION_LIMIT),
                vector: bounded(force, VECTOR_LIMIT),
                ..Packet::default()
            },
            _ => Packet::default(),
        };
        FollowerOutput { command, packet }
    }
}

/// As it goes into a frame: what is beyond the frame's range is sent as its
/// end, what is no number as zero.
fn bounded(values: [f64; 3], limit: f32) -> [f32; 3] {
    values.map(|value| {
        if value.is_nan() {
            0.0
        } else {
            (value as f32).clamp(-limit, limit)
        }
    })
}

#[cfg(test)]
mod tests;
