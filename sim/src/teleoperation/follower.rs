//! What is between the link's tip command and the surface.

use super::environment::Environment;
use super::tip::{Tip, TipParameters};
use super::whole_arm::{ArmUnderTrial, WholeArm};
use ferntast_control::link::FollowerReadings;
use ferntast_model::ParameterError;

/// What moves the tip of a trial.
#[derive(Clone, Debug, PartialEq)]
pub enum FollowerModel {
    /// A mass behind a spring, whose place and contact force are known without error: quick
    /// to try, and kinder than any arm.
    Light(TipParameters),
    /// The simulated arm behind the servo and the estimator that ship.
    Arm(Box<ArmUnderTrial>),
}

impl Default for FollowerModel {
    fn default() -> FollowerModel {
        FollowerModel::Light(TipParameters::default())
    }
}

impl FollowerModel {
    /// Checks every value against its bounds.
    ///
    /// # Errors
    ///
    /// The first value that is out of bounds.
    pub fn validate(&self) -> Result<(), ParameterError> {
        match self {
            FollowerModel::Light(tip) => tip.validate(),
            FollowerModel::Arm(own) => {
                own.arm.validate()?;
                own.servo.validate()
            }
        }
    }

    /// The follower at rest with its tip at `start` \[m\] before a surface at `origin`, base
    /// frame \[m\].
    pub(super) fn make(
        &self,
        environment: Environment,
        origin: [f64; 2],
        start: [f64; 2],
        seed: u64,
    ) -> Result<Box<dyn Follower>, ParameterError> {
        Ok(match self {
            FollowerModel::Light(tip) => Box::new(Tip::new(*tip, environment, origin, start)),
            FollowerModel::Arm(own) => Box::new(WholeArm::behind_servo(
                own,
                environment,
                origin,
                start,
                seed,
            )?),
        })
    }
}

/// Where the tip is to be, base frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct TipCommand {
    /// When it counts as made [ns].
    pub made_ns: i64,
    /// [m]
    pub position: [f64; 3],
}

/// What is true of the tip, from the surface's origin on: along x and y.
#[derive(Clone, Copy, Debug)]
pub struct TrueTip {
    /// \[m\]
    pub position: [f64; 2],
    /// Of the contact on it \[N\].
    pub force: [f64; 2],
    /// Of the contact on it since the start, in all directions \[J\].
    pub work: f64,
}

/// A follower with what it touches.
pub(super) trait Follower {
    /// Moves on by a tick to `now_ns`; the surface began to move `since` [s] ago. A command
    /// holds until there is another one.
    fn step(&mut self, now_ns: i64, since: f64, command: Option<TipCommand>);
    /// What is true now.
    fn truth(&self) -> TrueTip;
    /// What the link's end is told, base frame.
    fn readings(&self) -> FollowerReadings;
}
