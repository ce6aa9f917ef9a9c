//! An end of any law, with the energy at its port.

use super::{
    Energy, EnergyMeter, Follower, FollowerInput, FollowerLaw, FollowerOutput, Leader, LeaderInput,
    LeaderLaw, LeaderOutput,
};

/// The leader's end of a law, with the energy at its port.
#[derive(Clone, Debug)]
pub struct LeaderEnd {
    law: LeaderLaw,
    energy: EnergyMeter,
    /// On the hand since the last step [N].
    force: [f64; 3],
}

impl LeaderEnd {
    pub(super) fn new(law: LeaderLaw) -> LeaderEnd {
        LeaderEnd {
            law,
            energy: EnergyMeter::default(),
            force: [0.0; 3],
        }
    }

    /// One step of `dt` \[s\].
    pub fn step(&mut self, dt: f64, input: &LeaderInput) -> LeaderOutput {
        // The force since the last step worked along the way of the hand since
        // then; what enters the two-port is the work against it.
        let into = self.force.map(|force| -force);
        self.energy.step(into, input.hand.map(|hand| hand.position));
        let output = self.law.step(dt, input, self.energy.energy());
        self.force = output.force;
        output
    }

    /// `force` \[N\] is on the hand until the next step: what the master made of the
    /// force that the last step asked for, which is taken for it otherwise.
    pub fn rendered(&mut self, force: [f64; 3]) {
        self.force = force;
    }

    /// Energy at the leader's port, of the force that was on the hand.
    pub fn energy(&self) -> Energy {
        self.energy.energy()
    }

    /// Energy that the law itself dissipated at this end since the start \[J\].
    pub fn dissipated(&self) -> f64 {
        self.law.dissipated()
    }
}

/// The follower's end of a law, with the energy at its port.
#[derive(Clone, Debug)]
pub struct FollowerEnd {
    law: FollowerLaw,
    energy: EnergyMeter,
    /// At the last step \[N\].
    force: [f64; 3],
}

impl FollowerEnd {
    pub(super) fn new(law: FollowerLaw) -> FollowerEnd {
        FollowerEnd {
            law,
            energy: EnergyMeter::default(),
            force: [0.0; 3],
        }
    }

    /// One step of `dt` \[s\].
    pub fn step(&mut self, dt: f64, input: &FollowerInput) -> FollowerOutput {
        let force = input.contact_force.unwrap_or([0.0; 3]);
        // The contact's force changed on the way: its mean did the work.
        let mean = std::array::from_fn(|axis| 0.5 * (force[axis] + self.force[axis]));
        self.force = force;
        self.energy.step(mean, input.tip.map(|tip| tip.position));
        self.law.step(dt, input, self.energy.energy())
    }

    /// Energy at the follower's port: what the contact gave to the tip went in.
    pub fn energy(&self) -> Energy {
        self.energy.energy()
    }

    /// Energy that the law itself dissipated at this end since the start \[J\].
    pub fn dissipated(&self) -> f64 {
        self.law.dissipated()
    }
}
