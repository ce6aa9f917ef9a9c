//! Hand, arm and master of a sweep, the same in all of its trials.

use ferntast_config::{ConfigError, stiff_enough};
use ferntast_control::{codec::Deadband, delay::Law, haptics::MasterConfig, servo};
use ferntast_emulation::hand::ImpedanceParameters;
use ferntast_model::ParameterError;
use ferntast_sim::teleoperation::{Draw, FollowerModel, Outcome, Trial};

use super::{Condition, SweepConfig};

/// What all trials of a sweep have in common.
#[derive(Clone, Debug)]
pub struct Bench {
    hand: ImpedanceParameters,
    follower: FollowerModel,
    master: Option<MasterConfig>,
    /// Of the arm's servo at the tip [N/m].
    stiffness: Option<f64>,
    deadband: Option<Deadband>,
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
            deadband: config.codec.of(config.deadband),
        })
    }

    /// Runs the trial of `condition`.
    ///
    /// # Errors
    ///
    /// The first value that is out of bounds.
    pub fn run(&self, condition: &Condition) -> Result<Outcome, ParameterError> {
        let law = self.stiff_enough(&condition.law);
        let trial = Trial {
            hand: self.hand,
            follower: self.follower.clone(),
            master: self.master.clone(),
            task: condition.task,
            buffer: 1e-3 * condition.buffer_ms,
            deadband: self.deadband,
            ..Trial::new(law, condition.link(), condition.environment, condition.seed)
        };
        trial.run()
    }

    /// The trial of `seed` with `law` between scales, channel, hand, surface and task drawn at
    /// random.
    pub fn drawn(&self, law: &Law, seed: u64) -> Trial {
        let own = |draw: &mut Draw| self.stiff_enough(&draw.scaled(law));
        Trial {
            deadband: self.deadband,
            ..Trial::drawn(seed, self.follower.clone(), self.master.clone(), own)
        }
    }

    /// `law`, with a servo that is as stiff as that of the arm.
    fn stiff_enough(&self, law: &Law) -> Law {
        match self.stiffness {
            Some(least) => stiff_enough(law, least),
            None => law.clone(),
        }
    }
}
