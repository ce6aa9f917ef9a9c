//! Position forward, position back: a spring between hand and tip, with the
//! damping that its delay needs.
//!
//! F = K (x_s(t − T₂) − x_h) − B v_h and, at the tip, which is told where to go
//! rather than pushed, 0 = K (x_h(t − T₁) − x_s) − B v_s + F_e: the "P + d"
//! controllers of Nuño, Basañez, Ortega, Spong 2009, "Position tracking for
//! non-linear teleoperators with variable time delay" (IJRR 28), in hand units.
//!
//! **What it guarantees.** Their condition, 4 B_h B_s ≥ (T₁ + T₂)² K², for the longest
//! age of what is acted on, holding and loss included, makes ½K |x_h − x_s|² and
//! what the dampers take bound what the ports can give: the two-port is
//! passive by its own books. Each end has its own B = ½ K τ + b, with τ the longest round trip that
//! it measured of late, or twice the age of what it acts on (`delay.rs`); what is older than τ/2 as the other
//! end can know it by then is not acted on. Assumed: the tip is where it was told to be. Not over
//! an outage: coming back with hand and tip
//! apart stretches the spring at nobody's cost, by ½ K |x_h − x_s|². A long
//! delay feels like syrup.
//!
//! **On loss.** As the other laws: no command, the force fades out.

mod delay;
#[cfg(test)]
mod tests;

use super::contact::LastCommand;
use super::mapping::{ForceRamp, Mapping, law_ends, law_parameters};
use super::{
    Energy, Follower, FollowerInput, FollowerOutput, Leader, LeaderInput, LeaderOutput, Packet,
    Samples, vector,
};
use delay::MeasuredDelay;
use nalgebra::Vector3;

law_parameters! {
    /// Parameters of the law. Every key may be left out.
    pub struct PositionPosition {
        /// K: stiffness of the coupling, at the hand's scale \[N/m\].
        pub stiffness: f64 [0.1..=10000.0, "N/m"] = 200.0,
        /// b: damping at each end on top of what the delay needs \[N·s/m\].
        pub damping: f64 [0.1..=1000.0, "N·s/m"] = 5.0,
        /// Least τ; a longer round trip is measured \[s\].
        pub round_trip: f64 [0.002..=10.0, "s"] = 0.02,
        /// Largest τ: of what is older than half of it nothing is acted on \[s\].
        pub longest_round_trip: f64 [0.002..=10.0, "s"] = 2.5,
    }
}

law_ends!(
    PositionPosition,
    "position_position",
    ByItsBooksWhileConnected,
    PositionPositionLeader,
    PositionPositionFollower
);

impl PositionPosition {
    /// B: damping at an end for a round trip of τ \[s\] \[N·s/m\].
    fn whole_damping(&self, round_trip: f64) -> f64 {
        0.5 * self.stiffness * round_trip + self.damping
    }

    fn samples(&self) -> [Samples; 2] {
        [Samples::MOTION; 2]
    }

    /// A measured delay without anything measured.
    fn delay(&self) -> MeasuredDelay {
        MeasuredDelay::between(self.round_trip, self.longest_round_trip)
    }
}

/// The leader's end: sends position and velocity \[m/s\] of the hand.
#[derive(Clone, Debug)]
pub struct PositionPositionLeader {
    parameters: PositionPosition,
    mapping: Mapping,
    fade: ForceRamp,
    delay: MeasuredDelay,
    /// Newest, hand units [m].
    tip: Vector3<f64>,
    dissipated: f64,
}

impl PositionPositionLeader {
    fn new(law: &PositionPosition) -> Self {
        PositionPositionLeader {
            parameters: law.clone(),
            mapping: law.mapping(),
            fade: ForceRamp::default(),
            delay: law.delay(),
            tip: Vector3::zeros(),
            dissipated: 0.0,
        }
    }
}

impl Leader for PositionPositionLeader {
    fn step(&mut self, dt: f64, input: &LeaderInput, energy: Energy) -> LeaderOutput {
        let own = &self.parameters;
        let live = self.mapping.live(input.connected, input.received);
        let live = self.delay.step(dt, live);
        let damping = own.whole_damping(self.delay.round_trip());
        if let Some(received) = live {
            self.tip = self
                .mapping
                .tip_at_hand(received.packet.position.map(f64::from));
        }
        let share = self.fade.step(dt, own.force_ramp, live.is_some());
        let force = input.hand.map_or(Vector3::zeros(), |hand| {
            let velocity = Vector3::from(hand.velocity);
            self.dissipated += damping * velocity.norm_squared() * dt;
            share * own.stiffness * (self.tip - Vector3::from(hand.position)) - damping * velocity
        });
        LeaderOutput {
            force: force.into(),
            packet: input.hand.map_or(Packet::empty(energy), |hand| {
                Packet::new(hand.position, hand.velocity, energy)
            }),
        }
    }

    fn dissipated(&self) -> f64 {
        self.dissipated
    }
}

/// The follower's end: sends position and velocity \[m/s\] of the tip.
#[derive(Clone, Debug)]
pub struct PositionPositionFollower {
    parameters: PositionPosition,
    mapping: Mapping,
    delay: MeasuredDelay,
    command: LastCommand,
    dissipated: f64,
}

impl PositionPositionFollower {
    fn new(law: &PositionPosition) -> Self {
        PositionPositionFollower {
            parameters: law.clone(),
            mapping: law.mapping(),
            delay: law.delay(),
            command: LastCommand::default(),
            dissipated: 0.0,
        }
    }
}

impl Follower for PositionPositionFollower {
    fn step(&mut self, dt: f64, input: &FollowerInput, energy: Energy) -> FollowerOutput {
        let own = &self.parameters;
        let live = self.mapping.live(input.connected, input.received);
        let live = self.delay.step(dt, live);
        let damping = own.whole_damping(self.delay.round_trip());
        let force = self
            .mapping
            .contact_at_hand(input.contact_force.unwrap_or([0.0; 3]));
        let command = live.zip(input.tip).map(|(received, tip)| {
            let here = self
                .command
                .position()
                .unwrap_or_else(|| self.mapping.tip_at_hand(tip.position));
            let pull = own.stiffness * (vector(received.packet.position) - here) + force;
            // Implicit in the spring: steady for every step.
            let velocity = pull / (damping + own.stiffness * dt);
            self.dissipated += damping * velocity.norm_squared() * dt;
            (here + velocity * dt, velocity)
        });
        let given = command.map(|(position, _)| position);
        self.command.step(dt, given, input.connected, own.deadline);
        FollowerOutput {
            command: command.map(|(position, velocity)| self.mapping.command(position, velocity)),
            packet: input.tip.map_or(Packet::empty(energy), |tip| {
                Packet::new(tip.position, tip.velocity, energy)
            }),
        }
    }

    fn commanded(&mut self, position: Vector3<f64>) {
        self.command.replace(position);
    }

    fn dissipated(&self) -> f64 {
        self.dissipated
    }
}
