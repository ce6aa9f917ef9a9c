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
//! **To add a law**: copy a neighbour's file, implement [`Parameters`],
//! [`Leader`] and [`Follower`], add its line in `law.rs`. Callers stay as they
//! are, tests and sweep pick it up ([`Law::all`]). Energy at both ports is
//! counted in [`LeaderEnd`] and [`FollowerEnd`], whatever the law
//! ([`EnergyMeter`]).

mod auto;
mod contact;
mod end;
mod energy;
mod energy_tank;
mod four_channel;
mod law;
mod mapping;
mod model_mediated;
mod paid_force;
mod position_force;
mod position_position;
mod samples;
mod step_velocity;
mod tdpa;
mod two_layer;
mod wave;

pub use auto::Auto;
pub use end::{FollowerEnd, LeaderEnd};
pub use energy::{Energy, EnergyMeter};
pub use four_channel::{FourChannel, FourChannelFollower, FourChannelLeader};
pub use law::{FollowerLaw, Law, LeaderLaw};
pub use mapping::Mapping;
pub use model_mediated::{ModelMediated, ModelMediatedFollower, ModelMediatedLeader, SurfaceModel};
pub use position_force::{PositionForce, PositionForceFollower, PositionForceLeader};
pub use position_position::{PositionPosition, PositionPositionFollower, PositionPositionLeader};
pub use samples::{Sample, Samples};
pub use tdpa::{Tdpa, TdpaFollower, TdpaLeader};
pub use two_layer::{InnerLaw, TwoLayer, TwoLayerFollower, TwoLayerLeader};
pub use wave::{Wave, WaveFollower, WaveLeader};

use nalgebra::Vector3;

/// Largest position in a frame \[m\].
pub const POSITION_LIMIT: f32 = 10.0;
/// Largest velocity \[m/s\] or force \[N\] in a frame.
pub const VECTOR_LIMIT: f32 = 10_000.0;
/// Largest energy in a frame \[J\].
pub const ENERGY_LIMIT: f32 = 1e9;

/// What travels in a frame, as the law has it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Packet {
    /// Whether position and vector mean anything.
    pub valid: bool,
    /// Position of hand or tip \[m\], or what the law says.
    pub position: [f32; 3],
    /// Velocity \[m/s\], force \[N\] or integral of a wave; the law says which.
    pub vector: [f32; 3],
    /// Energy that entered and left the sender's port \[J\]; of what entered a
    /// law may keep some back to pay its own debts.
    pub energy: [f32; 2],
}

impl Packet {
    /// A valid packet. What is beyond a frame's range is sent as its end, what
    /// is no number as zero.
    fn new(position: [f64; 3], vector: [f64; 3], energy: Energy) -> Packet {
        Packet {
            valid: true,
            position: bounded(position, POSITION_LIMIT),
            vector: bounded(vector, VECTOR_LIMIT),
            energy: energy.packet(),
        }
    }

    /// Nothing to say but what went through the port.
    fn empty(energy: Energy) -> Packet {
        Packet {
            energy: energy.packet(),
            ..Packet::default()
        }
    }
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
    /// Forth and back as measured, with what frames wait at both ends to be played out, however
    /// far the clocks are apart \[s\]; zero before the first measurement.
    pub round_trip: f64,
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
    /// One step of `dt` \[s\]; `energy` is what went through this end's port.
    fn step(&mut self, dt: f64, input: &LeaderInput, energy: Energy) -> LeaderOutput;
    /// Of the force of the last step `force` \[N\] was given, where that is not what the step said.
    fn given(&mut self, force: Vector3<f64>) {
        let _ = force;
    }
    /// How much there is for the hand to touch, from 0, where nothing is near, to 1, at something
    /// stiff \[-\]. A law that does not know says 1.
    fn nearness(&self) -> f64 {
        1.0
    }
    /// Energy that the law itself dissipated at this end since the start \[J\].
    fn dissipated(&self) -> f64 {
        0.0
    }
}

/// The follower's end of a law.
pub trait Follower {
    /// One step of `dt` \[s\]; `energy` is what went through this end's port.
    fn step(&mut self, dt: f64, input: &FollowerInput, energy: Energy) -> FollowerOutput;
    /// The command of the last step was given as `position` \[m\], hand units, where that is
    /// not what the step said.
    fn commanded(&mut self, position: Vector3<f64>) {
        let _ = position;
    }
    /// Energy that the law itself dissipated at this end since the start \[J\].
    fn dissipated(&self) -> f64 {
        0.0
    }
}

/// What a law guarantees about the energy of the two-port between hand and tip.
/// Under which assumptions, the law's file says.
///
/// A law's own books take the servo for a spring with a damper and the estimated contact
/// force for the true one; at the hand they have the force that the master rendered. With a
/// whole arm, its servo and its estimator each of the laws that are passive by these makes
/// energy (`sim/tests/simulated/long/whole_arm.rs`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Guarantee {
    /// Nothing.
    Nothing,
    /// By its own books it gives out no more than it took in while frames arrive; an outage
    /// may add energy.
    ByItsBooksWhileConnected,
    /// By its own books it gives out no more than it took in, whatever the channel does.
    ByItsBooks,
    /// At hand and tip it gives out no more than it took in, whatever the channel does, with
    /// the arm, the servo and the estimator that ship.
    Passive,
}

/// The parameters of a law: what makes its two ends.
pub trait Parameters {
    /// Name of the law, as in configurations.
    const NAME: &'static str;
    /// The leader's end.
    type Leader: Leader;
    /// The follower's end.
    type Follower: Follower;
    /// What the law guarantees.
    fn guarantee(&self) -> Guarantee;
    /// Scales between hand and tip.
    fn mapping(&self) -> Mapping;
    /// What its packets say: the leader's, the follower's.
    fn samples(&self) -> [Samples; 2];
    /// The same law between the scales of `mapping`.
    #[must_use]
    fn between(&self, mapping: &Mapping) -> Self;
    /// The leader's end, at rest.
    fn leader(&self) -> Self::Leader;
    /// The follower's end, at rest.
    fn follower(&self) -> Self::Follower;
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

/// From a frame.
fn vector(values: [f32; 3]) -> Vector3<f64> {
    Vector3::from(values.map(f64::from))
}
