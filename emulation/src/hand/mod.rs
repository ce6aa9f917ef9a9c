//! The hand that is not there: a scripted operator with an impedance, or a
//! recorded human motion.
//!
//! Positions are in the leader's base frame; those of a recording, and of a script that
//! gives no z, are in the plane z = 0. Time passes
//! by [`Hand::step`] alone; all chance comes from the seed.

mod impedance;
mod recorded;
mod script;
mod tremor;
mod turn;

pub use impedance::{HandImpedance, ImpedanceParameters};
pub use recorded::{RecordedHand, RecordedHandConfig, RecordedMotion, RecordingError};
pub use script::{Motion, Phase, Point, Script, ScriptedHand, ScriptedHandConfig};
pub use tremor::{Tremor, TremorParameters};
pub use turn::{Turn, TurnParameters};

/// Where the hand is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HandState {
    /// Position, leader base frame \[m\].
    pub position: [f64; 3],
    /// Velocity \[m/s\].
    pub velocity: [f64; 3],
    /// How it is turned, leader base frame: quaternion x, y, z, w. `None` of a hand that does not
    /// say so.
    pub orientation: Option<[f64; 4]>,
    /// The script or recording has come to its end; the hand stays.
    pub finished: bool,
}

/// A hand of either kind.
#[derive(Clone, Debug)]
pub enum Hand {
    /// Follows a script, gives way to forces.
    Scripted(Box<ScriptedHand>),
    /// Follows a recording, whatever the force.
    Recorded(RecordedHand),
}

impl Hand {
    /// Moves on by `dt` \[s\] under `force` on the hand \[N\].
    pub fn step(&mut self, dt: f64, force: [f64; 3]) -> HandState {
        match self {
            Hand::Scripted(hand) => hand.step(dt, force),
            Hand::Recorded(hand) => hand.step(dt),
        }
    }

    /// What it is doing, for people.
    pub fn label(&self) -> &str {
        match self {
            Hand::Scripted(hand) => hand.label(),
            Hand::Recorded(_) => "recorded",
        }
    }
}
