//! What a sweep is made of: a file such as `config/scenarios/delay_sweep.toml`.

use ferntast_config::{self, ConfigError, FileKind};
use ferntast_control::codec::{Codec, Deadband};
use ferntast_control::delay::Law;
use ferntast_control::haptics::MasterConfig;
use ferntast_control::servo::ServoConfig;
use ferntast_drivers::simulated;
use ferntast_emulation::hand::ImpedanceParameters;
use ferntast_model::{ParameterError, check, parameters};
use ferntast_sim::teleoperation::{ArmUnderTrial, Environment, FollowerModel, Task, TipParameters};

/// Trials of one sweep at most.
const MAX_TRIALS: usize = 1_000_000;

parameters! {
    /// What is swept over.
    pub struct SweepConfig {
        /// What it shows, in a sentence.
        pub description: String,
        /// The laws with their parameters.
        pub laws: Vec<Law> [section],
        /// Round trips, half of it each way \[ms\].
        pub rtt_ms: Vec<f64> [0.0..=5000.0, "ms"],
        /// Standard deviations of the delay, each way \[ms\].
        pub jitter_ms: Vec<f64> [0.0..=1000.0, "ms"],
        /// Jitter buffer of both ends, in standard deviations of the delay, and 200 ms at most:
        /// frames that come later than that count as lost \[-\].
        #[serde(default = "buffer_per_jitter")]
        pub buffer_per_jitter: f64 [0.0..=10.0, "-"],
        /// Shares of frames lost, each way \[-\].
        pub loss: Vec<f64> [0.0..=1.0, "-"],
        /// What the tip meets.
        pub environments: Vec<Environment>,
        /// What the operator does.
        #[serde(default = "one_task")]
        pub tasks: Vec<Task>,
        /// Seeds; where neither jitter nor loss leaves anything to chance, the
        /// first one stands for all.
        pub seeds: Vec<u64>,
        /// Which frames are sent, as in a scenario.
        #[serde(default)]
        pub codec: Codec,
        /// What a hand cannot tell, with `codec = "deadband"`.
        #[serde(default)]
        pub deadband: Deadband [section],
        /// The operator's hand.
        pub hand: ImpedanceParameters [section],
        /// The arm, as in a scenario: with its servo, its estimator and the master's limits as
        /// they ship. Left out: a light tip, known without error.
        #[serde(default)]
        pub arm: Option<String>,
        /// The arm's servo.
        #[serde(default)]
        pub servo: ServoConfig [section],
        /// The master.
        #[serde(default)]
        pub master: MasterConfig [section],
        /// The light tip behind its servo, where there is no arm.
        #[serde(default)]
        pub tip: TipParameters [section],
    }
    check SweepConfig::has_neither_nothing_nor_too_much;
}

/// What the operator does where a file does not say.
fn one_task() -> Vec<Task> {
    vec![Task::PressAndSlide]
}

/// Jitter buffer of both ends, in standard deviations of the delay \[-\]. Frames stay in order, so
/// that one which comes late holds up those behind it: behind 50 ms of jitter the arm paused in 162
/// of 360 trials with three, and in 2 with four (`two_layer`, seeds 51 to 60).
pub(super) const BUFFER_PER_JITTER: f64 = 4.0;

fn buffer_per_jitter() -> f64 {
    BUFFER_PER_JITTER
}

/// A law that a sweep has not.
#[derive(Debug, thiserror::Error)]
#[error("--law {name}: the sweep has {has}")]
pub struct NotSwept {
    name: String,
    has: String,
}

/// Where sweeps are.
const FILE: FileKind = FileKind {
    name: "sweep",
    folder: "scenarios",
};

impl SweepConfig {
    /// Loads the sweep `name`, shipped or a file.
    ///
    /// # Errors
    ///
    /// What is wrong, in which file, and how to correct it.
    pub fn load(name: &str) -> Result<SweepConfig, ConfigError> {
        ferntast_config::load(FILE, name, SweepConfig::validate)
    }

    /// Leaves only the laws of these names; all where none is named.
    ///
    /// # Errors
    ///
    /// A name that the sweep has not.
    pub fn only(&mut self, laws: &[String]) -> Result<(), NotSwept> {
        let has = |name: &str| self.laws.iter().any(|law| law.name() == name);
        if let Some(name) = laws.iter().find(|name| !has(name)) {
            let names: Vec<&str> = self.laws.iter().map(|law| law.name()).collect();
            return Err(NotSwept {
                name: name.clone(),
                has: names.join(", "),
            });
        }
        if !laws.is_empty() {
            self.laws
                .retain(|law| laws.iter().any(|name| name == law.name()));
        }
        Ok(())
    }

    /// What follows the hand, and what limits the force on it.
    ///
    /// # Errors
    ///
    /// The arm's file cannot be loaded.
    pub fn follower(&self) -> Result<(FollowerModel, Option<MasterConfig>), ConfigError> {
        let Some(name) = &self.arm else {
            return Ok((FollowerModel::Light(self.tip), None));
        };
        let arm = ArmUnderTrial {
            arm: simulated::load_config(name)?,
            servo: self.servo.clone(),
        };
        let follower = FollowerModel::Arm(Box::new(arm));
        Ok((follower, Some(self.master.clone())))
    }

    fn has_neither_nothing_nor_too_much(&self) -> Result<(), ParameterError> {
        let counts = [
            ("laws", self.laws.len()),
            ("rtt_ms", self.rtt_ms.len()),
            ("jitter_ms", self.jitter_ms.len()),
            ("loss", self.loss.len()),
            ("environments", self.environments.len()),
            ("tasks", self.tasks.len()),
            ("seeds", self.seeds.len()),
        ];
        let mut trials = 1_usize;
        for (key, count) in counts {
            check(key, count as f64, 1.0, 10_000.0, "entries")?;
            trials = trials.saturating_mul(count);
        }
        check("trials in all", trials as f64, 1.0, MAX_TRIALS as f64, "-")
    }
}
