//! The layers at the operator's end.

use super::inside::InnerLeader;
use super::parameters::TwoLayer;
use crate::delay::energy_tank::EnergyTank;
use crate::delay::mapping::Mapping;
use crate::delay::paid_force::PaidForce;
use crate::delay::step_velocity::StepVelocity;
use crate::delay::{Energy, Leader, LeaderInput, LeaderOutput};
use nalgebra::Vector3;

/// Within this the hand's end forgets how much more had come in than went out before [s]: a hand
/// that goes to and fro on a surface gives the same energy again and again.
const MEMORY: f64 = 0.5;

/// The leader's end: sends what the inner law says, and what it promises.
#[derive(Clone, Debug)]
pub struct TwoLayerLeader {
    parameters: TwoLayer,
    mapping: Mapping,
    inner: InnerLeader,
    tank: EnergyTank,
    velocity: StepVelocity,
    force: PaidForce,
}

impl TwoLayerLeader {
    pub(super) fn new(law: &TwoLayer) -> Self {
        TwoLayerLeader {
            parameters: law.clone(),
            mapping: law.mapping(),
            inner: law.inside.between(&law.mapping()).bare_leader(),
            tank: EnergyTank::default(),
            velocity: StepVelocity::default(),
            force: PaidForce::new(law.force_rate, law.hand_mass),
        }
    }
}

impl Leader for TwoLayerLeader {
    fn step(&mut self, dt: f64, input: &LeaderInput, energy: Energy) -> LeaderOutput {
        let own = &self.parameters;
        self.tank
            .port_beyond(dt, energy, own.promised_share, MEMORY);
        if let Some(received) = self.mapping.live(input.connected, input.received) {
            self.tank.promise(f64::from(received.packet.energy[0]));
        }
        self.tank.give(dt / own.refill_time, own.kept_at_hand);
        self.tank.limit(own.reserve);
        let wanted = self.inner.step(dt, input, energy);
        let packet = self.tank.told_in(wanted.packet, energy);
        let Some(hand) = input.hand else {
            self.velocity.forget();
            self.force.forget();
            return LeaderOutput {
                force: [0.0; 3],
                packet,
            };
        };
        let velocity = self.velocity.step(dt, &hand);
        let lacking = 1.0 - (self.tank.level() / own.level.max(1e-9)).clamp(0.0, 1.0);
        let near = self.inner.nearness();
        let filling = near * own.largest_damping + (1.0 - near) * own.largest_free_damping;
        let damping = filling * lacking * Vector3::from(hand.velocity);
        let wanted = wanted.force.into();
        let force = self.force.step(dt, wanted, damping, &velocity, &self.tank);
        self.inner.given(force + damping);
        LeaderOutput {
            force: force.into(),
            packet,
        }
    }

    fn dissipated(&self) -> f64 {
        self.tank.dissipated() + self.inner.dissipated()
    }
}
