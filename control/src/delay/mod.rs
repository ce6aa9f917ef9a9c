//! Delay laws: what each end of the link makes of what arrives late.
//!
//! One file, one law, one variant of [`Law`]. A law has two ends. The leader's
//! end takes the hand and the newest packet from the follower and gives the
//! force on the hand and the packet to send; the follower's end takes the tip,
//! the contact force and the newest packet from the leader and gives the tip
//! command, if any, and the packet to send.
//!
//! Forces and positions at the leader are in the leader's frame, at the
//! follower in the follower's base frame. The force on the hand has the sign
//! of the force that the contact exerts on the tip.
//!
//! **To add a law**: copy a neighbour's file, add its variant to [`Law`],
//! [`LeaderLaw`] and [`FollowerLaw`]. Callers stay as they are. Energy at both
//! ports is counted here, whatever the law ([`EnergyMeter`]).

mod energy;
mod position_force;

pub use energy::{Energy, EnergyMeter};
pub use position_force::{PositionForce, PositionForceFollower, PositionForceLeader};

use ferntast_model::ParameterError;
use serde::{Deserialize, Serialize};

/// What travels in a frame, as the law has it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Packet {
    /// Whether position and vector mean anything.
    pub valid: bool,
    /// Position of hand or tip \[m\].
    pub position: [f32; 3],
    /// Velocity \[m/s\] or force \[N\]; the law says which.
    pub vector: [f32; 3],
    /// Energy that entered and left the sender's port \[J\].
    pub energy: [f32; 2],
}

/// Position and velocity of hand or tip.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// \[m\]
    pub position: [f64; 3],
    /// \[m/s\]
    pub velocity: [f64; 3],
}

/// The newest packet from the other end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Received {
    /// Its content.
    pub packet: Packet,
    /// It arrived since the last step.
    pub fresh: bool,
    /// Time since it arrived \[s\].
    pub silence: f64,
    /// Time since it was sent, as far as both clocks agree \[s\].
    pub age: f64,
}

/// What a step of the leader's end takes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LeaderInput {
    /// The hand, while it is valid.
    pub hand: Option<Motion>,
    /// The newest packet from the follower.
    pub received: Option<Received>,
    /// Frames arrive and the follower does not ask to hold.
    pub connected: bool,
}

/// What a step of the leader's end gives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LeaderOutput {
    /// Force on the hand \[N\].
    pub force: [f64; 3],
    /// To send.
    pub packet: Packet,
}

/// What a step of the follower's end takes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FollowerInput {
    /// The measured tip, while it is valid.
    pub tip: Option<Motion>,
    /// The estimated force of the contact on the tip \[N\], while it is valid.
    pub contact_force: Option<[f64; 3]>,
    /// The newest packet from the leader.
    pub received: Option<Received>,
    /// Frames arrive and the leader does not ask to hold.
    pub connected: bool,
}

/// What a step of the follower's end gives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FollowerOutput {
    /// A new tip command; `None` when there is nothing new. Nothing is
    /// repeated: the servo's watchdog counts from the last one.
    pub command: Option<Motion>,
    /// To send.
    pub packet: Packet,
}

/// The leader's end of a law.
pub trait Leader {
    /// One step of `dt` \[s\].
    fn step(&mut self, dt: f64, input: &LeaderInput) -> LeaderOutput;
    /// Energy that the law itself dissipated at this end since the start \[J\].
    fn dissipated(&self) -> f64 {
        0.0
    }
}

/// The follower's end of a law.
pub trait Follower {
    /// One step of `dt` \[s\].
    fn step(&mut self, dt: f64, input: &FollowerInput) -> FollowerOutput;
    /// Energy that the law itself dissipated at this end since the start \[J\].
    fn dissipated(&self) -> f64 {
        0.0
    }
}

/// Which law, with its parameters: the section `[law]` of a configuration.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Law {
    /// Position forward, force back.
    PositionForce(PositionForce),
}

impl Default for Law {
    fn default() -> Self {
        Law::PositionForce(PositionForce::default())
    }
}

impl Law {
    /// Its name, as in configurations.
    pub const fn name(&self) -> &'static str {
        match self {
            Law::PositionForce(_) => "position_force",
        }
    }

    /// Checks every value against its bounds.
    ///
    /// # Errors
    ///
    /// The first value that is out of bounds.
    pub fn validate(&self) -> Result<(), ParameterError> {
        match self {
            Law::PositionForce(law) => law.validate(),
        }
    }

    /// The leader's end.
    pub fn leader(&self) -> LeaderEnd {
        LeaderEnd {
            law: match self {
                Law::PositionForce(law) => LeaderLaw::PositionForce(law.leader()),
            },
            energy: EnergyMeter::default(),
            force: [0.0; 3],
        }
    }

    /// The follower's end.
    pub fn follower(&self) -> FollowerEnd {
        FollowerEnd {
            law: match self {
                Law::PositionForce(law) => FollowerLaw::PositionForce(law.follower()),
            },
            energy: EnergyMeter::default(),
        }
    }
}

/// The leader's end of any law.
#[derive(Clone, Debug)]
pub enum LeaderLaw {
    /// Position forward, force back.
    PositionForce(PositionForceLeader),
}

/// The follower's end of any law.
#[derive(Clone, Debug)]
pub enum FollowerLaw {
    /// Position forward, force back.
    PositionForce(PositionForceFollower),
}

/// The leader's end of a law, with the energy at its port.
#[derive(Clone, Debug)]
pub struct LeaderEnd {
    law: LeaderLaw,
    energy: EnergyMeter,
    /// Given at the last step, acting until this one [N].
    force: [f64; 3],
}

impl LeaderEnd {
    /// One step of `dt` \[s\].
    pub fn step(&mut self, dt: f64, input: &LeaderInput) -> LeaderOutput {
        // The force since the last step worked along the way of the hand since
        // then; what enters the two-port is the work against it.
        let into = self.force.map(|force| -force);
        self.energy.step(into, input.hand.map(|hand| hand.position));
        let mut output = match &mut self.law {
            LeaderLaw::PositionForce(law) => law.step(dt, input),
        };
        output.packet.energy = self.energy.energy().packet();
        self.force = output.force;
        output
    }

    /// Energy at the leader's port, counted from the force that this end asks for.
    pub fn energy(&self) -> Energy {
        self.energy.energy()
    }

    /// Energy that the law itself dissipated at this end since the start \[J\].
    pub fn dissipated(&self) -> f64 {
        match &self.law {
            LeaderLaw::PositionForce(law) => law.dissipated(),
        }
    }
}

/// The follower's end of a law, with the energy at its port.
#[derive(Clone, Debug)]
pub struct FollowerEnd {
    law: FollowerLaw,
    energy: EnergyMeter,
}

impl FollowerEnd {
    /// One step of `dt` \[s\].
    pub fn step(&mut self, dt: f64, input: &FollowerInput) -> FollowerOutput {
        let force = input.contact_force.unwrap_or([0.0; 3]);
        self.energy.step(force, input.tip.map(|tip| tip.position));
        let mut output = match &mut self.law {
            FollowerLaw::PositionForce(law) => law.step(dt, input),
        };
        output.packet.energy = self.energy.energy().packet();
        output
    }

    /// Energy at the follower's port: what the contact gave to the tip went in.
    pub fn energy(&self) -> Energy {
        self.energy.energy()
    }

    /// Energy that the law itself dissipated at this end since the start \[J\].
    pub fn dissipated(&self) -> f64 {
        match &self.law {
            FollowerLaw::PositionForce(law) => law.dissipated(),
        }
    }
}
