//! Hand, arm and master of a sweep, the same in all of its trials.

use ferntast_control::{haptics::MasterConfig, servo};
use ferntast_emulation::hand::ImpedanceParameters;
use ferntast_model::ParameterError;
use ferntast_nodes::config::{ConfigError, stiff_enough};
use ferntast_sim::teleoperation::{FollowerModel, Outcome, Trial};

use super::{Condition, SweepConfig};

/// What all trials of a sweep have in common.
#[derive(Clone, Debug)]
pub struct Bench {
    hand: ImpedanceParameters,
    follower: FollowerModel,
    master: Option<MasterConfig>,
    /// Of the arm's servo at the tip [N/m].
    stiffness: Option<f64>,
}

impl Bench {
    /// The hand and the arm of `config`.
    ///
    /// # Errors
    ///
    /// The arm's file cannot be loaded.
    pub fn new(config: &SweepConfig) -> Result<Bench, ConfigError> {
        let (follower, master) = config.follower()?;
        let stiffness = match &follower {
            FollowerModel::Arm(own) => servo::stiffest(&own.arm.model(), &own.servo),
            FollowerModel::Light(_) => None,
        };
        Ok(Bench {
            hand: config.hand,
            follower,
            master,
            stiffness,
        })
    }

    /// Runs the trial of `condition`.
    ///
    /// # Errors
    ///
    /// The first value that is out of bounds.
    pub fn run(&self, condition: &Condition) -> Result<Outcome, ParameterError> {
        let law = match self.stiffness {
            Some(least) => stiff_enough(&condition.law, least),
            None => condition.law.clone(),
        };
        let trial = Trial {
            hand: self.hand,
            follower: self.follower.clone(),
            master: self.master.clone(),
            task: condition.task,
            buffer: 1e-3 * condition.buffer_ms,
            ..Trial::new(law, condition.link(), condition.environment, condition.seed)
        };
        trial.run()
    }
}
