//! Which follower a trial has.

use super::environment::Environment;
use super::follower::Follower;
use super::tip::{Tip, TipParameters};
use super::whole_arm::{ArmUnderTrial, WholeArm};
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
