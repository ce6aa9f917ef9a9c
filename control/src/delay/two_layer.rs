//! Two layers: any law within limits of energy.
//!
//! The inner law, the layer of transparency, says what force the hand should feel and where
//! the tip should be. Around it, at each end, the layer of passivity lets of that pass what
//! the energy in a tank pays for (Franken, Stramigioli, Misra, Secchi, Macchelli 2011,
//! "Bilateral telemanipulation with time delays: a two-layer approach combining passivity and
//! transparency", IEEE T-RO 27):
//!
//! * What goes through hand and tip goes into the tanks or out of them: at the hand the work of
//!   the force that the master rendered, at the tip that of the estimated contact force along the
//!   way of the tip as late as the estimate. Of what comes in an end promises a share to the other
//!   one at once, and of what it holds beyond its own need the share Δt/`transfer_time` in each
//!   step, as a sum that only grows: what is lost on the way the next packet makes good.
//! * **The hand.** The force gives out no more than the tank has, one step ahead, and changes
//!   evenly. While the tank has less than `level`, the hand is damped, which fills it (the tank
//!   level controller).
//! * **The tip.** Behind it are a servo and a mass that store energy on their own account, and a
//!   contact gets all of that before anybody knows. So the tank has to hold it: the command moves
//!   no faster than ½ m v² ≤ E, and in contact it leads the tip, along the force with which it
//!   pushes, by no more than ½ k d² ≤ E. Franken et al. take from the force there; an arm
//!   that is told positions has none to take from. A command that was kept back catches up with a
//!   bounded acceleration, as an arm that is jerked feigns forces; and it never leads by
//!   more than `largest_lead`, as a servo that is slow to take over would wind up.
//!
//! The inner law goes on from the command that was given, not from the one that it wished for.
//!
//! **What it guarantees.** With `model_mediated` inside: at hand and tip no more energy leaves
//! than entered, up to 0.02 J, with the arm, the servo and the estimator that ship
//! (`sim/tests/true_ports.rs`). Around the others it takes nearly all of what they would make:
//! a tip that bounces on a wall, which they let it do, is quicker than the estimate of its force,
//! so that the books err.
//!
//! **On loss.** As the inner law. Nothing is spent that has not come in.

mod follower;
mod inside;

pub use follower::TwoLayerFollower;
pub use inside::InnerLaw;

use super::energy_tank::EnergyTank;
use super::mapping::{Mapping, law_parameters};
use super::{Energy, Guarantee, Leader, LeaderInput, LeaderOutput, Packet, Parameters};
use inside::InnerLeader;
use nalgebra::Vector3;

law_parameters! {
    /// Parameters of the law. Every key may be left out. The inner law has the scales that are
    /// given here.
    pub struct TwoLayer {
        /// The layer of transparency.
        pub inside: InnerLaw [section] = InnerLaw::default(),
        /// Share of what comes in through its port that an end gives to the other one at
        /// once \[-\].
        pub promised_share: f64 [0.0..=1.0, "-"] = 0.5,
        /// Time constant with which an end gives what it does not need to the other one \[s\].
        pub transfer_time: f64 [0.01..=100.0, "s"] = 0.12,
        /// Energy that the hand's end needs for itself \[J\].
        pub kept_at_hand: f64 [0.0..=100.0, "J"] = 0.04,
        /// Energy that the tip's end needs for itself, at the hand's scale \[J\].
        pub kept_at_tip: f64 [0.0..=100.0, "J"] = 0.005,
        /// Energy with which the tip's end begins, at the hand's scale: it lets the arm set out
        /// before the hand has paid for that \[J\].
        pub credit: f64 [0.0..=1.0, "J"] = 0.01,
        /// Energy that an end may hold, at the hand's scale; what is beyond counts as
        /// dissipated \[J\].
        pub reserve: f64 [0.0..=1000.0, "J"] = 0.3,
        /// Below this energy the hand is damped \[J\].
        pub level: f64 [0.0..=100.0, "J"] = 0.05,
        /// Largest damping at the hand that fills the tank \[N·s/m\].
        pub largest_damping: f64 [0.0..=1000.0, "N·s/m"] = 3.0,
        /// Largest change of the force on the hand \[N/s\].
        pub force_rate: f64 [1.0..=1e6, "N/s"] = 450.0,
        /// m_h: lightest mass of hand and handle \[kg\].
        pub hand_mass: f64 [0.01..=20.0, "kg"] = 0.2,
        /// m: mass of arm and motors at the tip \[kg\].
        pub tip_mass: f64 [0.01..=1000.0, "kg"] = 4.0,
        /// Speed that the tip's command may always have, at the hand's scale \[m/s\].
        pub least_speed: f64 [0.0..=1.0, "m/s"] = 0.01,
        /// Largest speed at which the tip gives way, at the hand's scale \[m/s\].
        pub yield_speed: f64 [0.001..=10.0, "m/s"] = 0.2,
        /// Largest lead of the command over the tip, at the tip \[m\].
        pub largest_lead: f64 [1e-4..=1.0, "m"] = 0.003,
        /// How late the contact's force is beside the tip, by the filters and the threshold of
        /// its estimate \[s\].
        pub force_lag: f64 [0.0..=0.1, "s"] = 0.016,
        /// k: stiffness of the arm's servo at the tip; a session takes the arm's own
        /// where that is larger \[N/m\].
        pub servo_stiffness: f64 [1.0..=1000000.0, "N/m"] = 7000.0,
    }
}

impl Parameters for TwoLayer {
    const NAME: &'static str = "two_layer";
    type Leader = TwoLayerLeader;
    type Follower = TwoLayerFollower;

    fn guarantee(&self) -> Guarantee {
        match self.inside {
            InnerLaw::ModelMediated(_) => Guarantee::Passive,
            _ => Guarantee::ByItsBooks,
        }
    }

    fn mapping(&self) -> Mapping {
        self.mapping()
    }

    fn between(&self, mapping: &Mapping) -> TwoLayer {
        self.between(mapping)
    }

    fn leader(&self) -> TwoLayerLeader {
        TwoLayerLeader::new(self)
    }

    fn follower(&self) -> TwoLayerFollower {
        TwoLayerFollower::new(self)
    }
}

/// The tank pays for the force on the hand so long ahead [s].
const FORESIGHT: f64 = 0.002;

/// What the inner law says, with what the layer of passivity says of energy.
fn packet(inner: Packet, tank: &EnergyTank, port: Energy) -> Packet {
    Packet {
        energy: tank.told(port).packet(),
        ..inner
    }
}

/// The leader's end: sends what the inner law says, and what it promises.
#[derive(Clone, Debug)]
pub struct TwoLayerLeader {
    parameters: TwoLayer,
    mapping: Mapping,
    inner: InnerLeader,
    tank: EnergyTank,
    /// Of the hand at the last step [m].
    position: Option<Vector3<f64>>,
    /// Asked for at the last step [N].
    force: Vector3<f64>,
}

impl TwoLayerLeader {
    fn new(law: &TwoLayer) -> Self {
        TwoLayerLeader {
            parameters: law.clone(),
            mapping: law.mapping(),
            inner: law.inside.between(&law.mapping()).bare_leader(),
            tank: EnergyTank::default(),
            position: None,
            force: Vector3::zeros(),
        }
    }
}

impl TwoLayerLeader {
    /// The force that the tank can let go of [N]: falling to zero at a rate r, f gives a hand of
    /// mass m that lets go the impulse f²/2r, and the energy (f²/2r)²/2m ≤ E.
    fn releasable(&self) -> f64 {
        let own = &self.parameters;
        let impulse = (2.0 * own.hand_mass * self.tank.level().max(0.0)).sqrt();
        (2.0 * own.force_rate * impulse).sqrt()
    }
}

impl Leader for TwoLayerLeader {
    fn step(&mut self, dt: f64, input: &LeaderInput, energy: Energy) -> LeaderOutput {
        let own = &self.parameters;
        self.tank.port(energy, own.promised_share);
        if let Some(received) = self.mapping.live(input.connected, input.received) {
            self.tank.promise(f64::from(received.packet.energy[0]));
        }
        self.tank.give(dt / own.transfer_time, own.kept_at_hand);
        self.tank.limit(own.reserve);
        let wanted = self.inner.step(dt, input, energy);
        let packet = packet(wanted.packet, &self.tank, energy);
        let Some(hand) = input.hand else {
            self.position = None;
            self.force = Vector3::zeros();
            return LeaderOutput {
                force: [0.0; 3],
                packet,
            };
        };
        let here = Vector3::from(hand.position);
        // Not the filtered velocity: one that lags would let the port give out.
        let velocity = match self.position {
            Some(before) if dt > 0.0 => (here - before) / dt,
            _ => hand.velocity.into(),
        };
        self.position = Some(here);
        let force = self
            .tank
            .pays_for(FORESIGHT, wanted.force.into(), velocity, own.hand_mass);
        let force = force.cap_magnitude(self.releasable());
        let lacking = 1.0 - (self.tank.level() / own.level.max(1e-9)).clamp(0.0, 1.0);
        let damping = own.largest_damping * lacking * Vector3::from(hand.velocity);
        self.force += (force - damping - self.force).cap_magnitude(own.force_rate * dt);
        LeaderOutput {
            force: self.force.into(),
            packet,
        }
    }

    fn dissipated(&self) -> f64 {
        self.tank.dissipated() + self.inner.dissipated()
    }
}

#[cfg(test)]
mod tests;
