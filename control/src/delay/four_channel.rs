//! Four channels: position and force both ways.
//!
//! The transparency-optimised architecture of Lawrence 1993 ("Stability and
//! transparency in bilateral teleoperation", IEEE T-RA 9, section IV; with local force
//! feedback: Hashtrudi-Zaad and Salcudean 2002, "Transparency in time-delayed
//! systems and the effect of local force feedback for transparent
//! teleoperation", IEEE T-RA 18), in hand units:
//!
//! F = F_s(t − T₂) + K (x_s(t − T₂) − x_h) + B (v_s − v_h) − D v_h and, at the tip, which
//! is told where to go rather than pushed,
//! 0 = K (x_h(t − T₁) − x_s) + B (v_h − v_s) + F_h(t − T₁) − F̂_s.
//!
//! F_h is what the hand gives: the force on it, turned round. At rest both say
//! x_s = x_h and F = F_s: without delay the hand feels what the tip touches, and
//! the tip is where the hand is. v_s of the other end is the difference of its
//! positions.
//!
//! **What the arm is late by.** With a tip that follows at once a force that the hand gives
//! comes back as −F_h one round trip later: a loop whose gain is 1 at every frequency. A
//! servo's lag then makes it swing, in free space already. So F_h goes out through a low
//! pass as slow as the loop, τ = T₁ + T₂ + λ with λ the arm's own lag, and the hand has the
//! damping that the lag of its spring asks for, D = K τ, no more than B (of the kind of Nuño,
//! Basañez, Ortega, Spong 2009, "Position tracking for non-linear teleoperators with variable
//! time delay", IJRR 28; found by trial on the simulated arm, no proof). At rest nothing
//! changes.
//!
//! **What it guarantees.** Nothing about stability. On a light tip it holds on a hard wall
//! to 1 s of round trip, with K = 1000 N/m too, and on the simulated arm at the scale of a
//! session (s_F = 0.05); at 1:1 that arm bounces on a hard wall. It gets heavier with the
//! delay: that is what pays.
//!
//! **On loss.** No command, the force fades out. Afterwards the command begins at
//! the tip and approaches by K and B.

use super::contact::{CommandForce, LastCommand, TouchingTip};
use super::mapping::{ForceRamp, Mapping, law_ends, law_parameters, shortened};
use super::{
    Energy, Follower, FollowerInput, FollowerOutput, Leader, LeaderInput, LeaderOutput, Packet,
    Samples, vector,
};
use crate::low_pass_share;
use nalgebra::Vector3;

law_parameters! {
    /// Parameters of the law. Every key may be left out.
    pub struct FourChannel {
        /// K: stiffness of the coupling, at the hand's scale \[N/m\].
        pub stiffness: f64 [0.1..=10000.0, "N/m"] = 200.0,
        /// B: damping of the coupling, at the hand's scale \[N·s/m\].
        pub damping: f64 [0.1..=1000.0, "N·s/m"] = 20.0,
        /// Largest speed of the tip's command, at the hand's scale \[m/s\].
        pub largest_speed: f64 [0.01..=10.0, "m/s"] = 1.0,
        /// Stiffness of the arm's servo at the tip; a session takes the arm's own
        /// where that is larger \[N/m\].
        pub servo_stiffness: f64 [1.0..=1000000.0, "N/m"] = 7000.0,
    }
}
law_ends!(
    FourChannel,
    "four_channel",
    Nothing,
    FourChannelLeader,
    FourChannelFollower
);

impl FourChannel {
    fn samples(&self) -> [Samples; 2] {
        [
            Samples::position_and_force(1.0),
            Samples::position_and_force(self.force_scale),
        ]
    }
}

/// Time constant of the velocity of what was received [s].
const VELOCITY_FILTER: f64 = 0.01;

/// λ: what an arm is late by from command to what is measured of it: servo, estimate and
/// rate of the other end's position [s].
const ARM_LAG: f64 = 0.05;

/// Position of the other end with its rate.
#[derive(Clone, Copy, Debug, Default)]
struct Other {
    position: Option<Vector3<f64>>,
    velocity: Vector3<f64>,
    since: f64,
}

impl Other {
    /// The newest position, `None` while there is nothing to act on.
    fn step(&mut self, dt: f64, newest: Option<(Vector3<f64>, bool)>) {
        self.since += dt;
        match (newest, self.position) {
            (None, _) => *self = Other::default(),
            (Some((now, true)), Some(before)) if self.since > 0.0 => {
                let share = low_pass_share(self.since, VELOCITY_FILTER);
                self.velocity += share * ((now - before) / self.since - self.velocity);
                self.position = Some(now);
                self.since = 0.0;
            }
            (Some((now, _)), None) => {
                self.position = Some(now);
                self.since = 0.0;
            }
            _ => {}
        }
    }
}

/// The leader's end: sends position of the hand and the force that it gives \[N\].
#[derive(Clone, Debug)]
pub struct FourChannelLeader {
    parameters: FourChannel,
    mapping: Mapping,
    fade: ForceRamp,
    tip: Other,
    /// The newest force received, hand units [N].
    contact: Vector3<f64>,
    /// At the last step, in place of the tip's after a loss [m].
    position: Vector3<f64>,
    /// F_h behind its low pass [N].
    given: Vector3<f64>,
}

impl FourChannelLeader {
    fn new(law: &FourChannel) -> Self {
        FourChannelLeader {
            parameters: law.clone(),
            mapping: law.mapping(),
            fade: ForceRamp::default(),
            tip: Other::default(),
            contact: Vector3::zeros(),
            position: Vector3::zeros(),
            given: Vector3::zeros(),
        }
    }
}

impl Leader for FourChannelLeader {
    fn step(&mut self, dt: f64, input: &LeaderInput, energy: Energy) -> LeaderOutput {
        let own = &self.parameters;
        let live = self.mapping.live(input.connected, input.received);
        let newest = live.map(|received| {
            let tip = received.packet.position.map(f64::from);
            (self.mapping.tip_at_hand(tip), received.fresh)
        });
        self.tip.step(dt, newest);
        if let Some(received) = live {
            let force = received.packet.vector.map(f64::from);
            self.contact = self.mapping.contact_at_hand(force);
        }
        let share = self.fade.step(dt, own.force_ramp, live.is_some());
        let Some(hand) = input.hand else {
            return LeaderOutput {
                force: [0.0; 3],
                packet: Packet::empty(energy),
            };
        };
        let here = Vector3::from(hand.position);
        if let Some(tip) = self.tip.position {
            self.position = tip;
        }
        let apart = self.position - here;
        let rate = self.tip.velocity - Vector3::from(hand.velocity);
        let age = live.map_or(0.0, |received| received.age.max(0.0));
        let late = ARM_LAG + 2.0 * age;
        let damping = (own.stiffness * late).min(own.damping);
        let force = share * (self.contact + own.stiffness * apart + own.damping * rate)
            - damping * Vector3::from(hand.velocity);
        self.given += low_pass_share(dt, late) * (-force - self.given);
        LeaderOutput {
            force: force.into(),
            packet: Packet::new(hand.position, self.given.into(), energy),
        }
    }
}

/// The follower's end: sends position of the tip and force of the contact on
/// it \[N\].
#[derive(Clone, Debug)]
pub struct FourChannelFollower {
    parameters: FourChannel,
    mapping: Mapping,
    force: CommandForce,
    hand: Other,
    command: LastCommand,
}

impl FourChannelFollower {
    fn new(law: &FourChannel) -> Self {
        let mapping = law.mapping();
        FourChannelFollower {
            parameters: law.clone(),
            mapping,
            force: CommandForce::new(mapping.stiffness_at_hand(law.servo_stiffness)),
            hand: Other::default(),
            command: LastCommand::default(),
        }
    }
}

impl Follower for FourChannelFollower {
    fn step(&mut self, dt: f64, input: &FollowerInput, energy: Energy) -> FollowerOutput {
        let own = &self.parameters;
        let live = self.mapping.live(input.connected, input.received);
        let newest = live.map(|received| (vector(received.packet.position), received.fresh));
        self.hand.step(dt, newest);
        let tip = TouchingTip::new(&self.mapping, input, &self.command);
        let here = tip.here;
        let pushed = self.force.step(dt, &tip);
        // Implicit in both springs.
        let give = own.damping + (own.stiffness + self.force.stiffness()) * dt;
        let command = live.zip(here).map(|(received, here)| {
            let pull = own.stiffness * (vector(received.packet.position) - here)
                + own.damping * self.hand.velocity
                + vector(received.packet.vector)
                - pushed;
            let velocity = shortened(pull / give, own.largest_speed);
            (here + velocity * dt, velocity)
        });
        let given = command.map(|(position, _)| position);
        self.command.step(dt, given, input.connected, own.deadline);
        FollowerOutput {
            command: command.map(|(position, velocity)| self.mapping.command(position, velocity)),
            packet: match (input.tip, input.contact_force) {
                (Some(tip), Some(force)) => Packet::new(tip.position, force, energy),
                _ => Packet::empty(energy),
            },
        }
    }

    fn commanded(&mut self, position: Vector3<f64>) {
        self.command.replace(position);
    }
}
