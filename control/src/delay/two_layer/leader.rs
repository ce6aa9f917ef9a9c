//! The layers at the operator's end.

use super::inside::InnerLeader;
use super::parameters::TwoLayer;
use crate::delay::energy_tank::EnergyTank;
use crate::delay::mapping::Mapping;
use crate::delay::step_velocity::StepVelocity;
use crate::delay::{Energy, Leader, LeaderInput, LeaderOutput};
use nalgebra::Vector3;

/// The tank pays for the force on the hand so long ahead [s].
const FORESIGHT: f64 = 0.002;

/// The leader's end: sends what the inner law says, and what it promises.
#[derive(Clone, Debug)]
pub struct TwoLayerLeader {
    parameters: TwoLayer,
    mapping: Mapping,
    inner: InnerLeader,
    tank: EnergyTank,
    velocity: StepVelocity,
    /// Asked for at the last step [N].
    force: Vector3<f64>,
}

impl TwoLayerLeader {
    pub(super) fn new(law: &TwoLayer) -> Self {
        TwoLayerLeader {
            parameters: law.clone(),
            mapping: law.mapping(),
            inner: law.inside.between(&law.mapping()).bare_leader(),
            tank: EnergyTank::default(),
            velocity: StepVelocity::default(),
            force: Vector3::zeros(),
        }
    }
}

impl TwoLayerLeader {
    /// The force along `force` that the tank can let go of [N]: falling to zero at a rate r, f
    /// gives a hand of mass m that lets go the impulse p = f²/2r, and where that moves along with
    /// the force at v already the energy p v + p²/2m ≤ E.
    fn releasable(&self, force: &Vector3<f64>, velocity: &Vector3<f64>) -> f64 {
        let own = &self.parameters;
        let speed = force
            .try_normalize(1e-9)
            .map_or(0.0, |along| velocity.dot(&along));
        let energy = self.tank.level().max(0.0);
        let fastest = (speed * speed + 2.0 * energy / own.hand_mass).sqrt();
        (2.0 * own.force_rate * own.hand_mass * (fastest - speed)).sqrt()
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
        let packet = self.tank.told_in(wanted.packet, energy);
        let Some(hand) = input.hand else {
            self.velocity.forget();
            self.force = Vector3::zeros();
            return LeaderOutput {
                force: [0.0; 3],
                packet,
            };
        };
        let velocity = self.velocity.step(dt, &hand);
        let force = self
            .tank
            .pays_for(FORESIGHT, wanted.force.into(), velocity, own.hand_mass);
        let force = force.cap_magnitude(self.releasable(&force, &velocity));
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
