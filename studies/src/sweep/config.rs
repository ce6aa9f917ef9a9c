//! What a sweep is made of: a file such as `config/scenarios/delay_sweep.toml`.

use ferntast_control::delay::Law;
use ferntast_emulation::hand::ImpedanceParameters;
use ferntast_model::{ParameterError, check};
use ferntast_nodes::config::{self, ConfigError, FileKind};
use ferntast_sim::teleoperation::{Environment, TipParameters};
use serde::{Deserialize, Serialize};

/// Most trials of one sweep.
const MOST_TRIALS: usize = 1_000_000;

/// What is swept over.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SweepConfig {
    /// What it shows, in a sentence.
    pub description: String,
    /// The laws with their parameters.
    pub laws: Vec<Law>,
    /// Round trips, half of it each way \[ms\].
    pub rtt_ms: Vec<f64>,
    /// Standard deviations of the delay, each way \[ms\].
    pub jitter_ms: Vec<f64>,
    /// Shares of frames lost, each way \[-\].
    pub loss: Vec<f64>,
    /// What the tip meets.
    pub environments: Vec<Environment>,
    /// Seeds; where neither jitter nor loss leaves anything to chance, the
    /// first one stands for all.
    pub seeds: Vec<u64>,
    /// The operator's hand.
    pub hand: ImpedanceParameters,
    /// The arm behind its servo.
    #[serde(default)]
    pub tip: TipParameters,
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
        config::load(FILE, name, SweepConfig::validate)
    }

    /// Checks every value against its bounds.
    ///
    /// # Errors
    ///
    /// The first value that is out of bounds, with key, value, bounds, unit.
    pub fn validate(&self) -> Result<(), ParameterError> {
        for law in &self.laws {
            let within = |error: ParameterError| error.within(&format!("laws ({})", law.name()));
            law.validate().map_err(within)?;
        }
        let counts = [
            ("laws", self.laws.len()),
            ("rtt_ms", self.rtt_ms.len()),
            ("jitter_ms", self.jitter_ms.len()),
            ("loss", self.loss.len()),
            ("environments", self.environments.len()),
            ("seeds", self.seeds.len()),
        ];
        let mut trials = 1_usize;
        for (key, count) in counts {
            check(key, count as f64, 1.0, 10_000.0, "entries")?;
            trials = trials.saturating_mul(count);
        }
        check("trials in all", trials as f64, 1.0, MOST_TRIALS as f64, "-")?;
        each("rtt_ms", &self.rtt_ms, 5000.0, "ms")?;
        each("jitter_ms", &self.jitter_ms, 1000.0, "ms")?;
        each("loss", &self.loss, 1.0, "-")?;
        self.hand.validate().map_err(|error| error.within("hand"))
    }
}

fn each(key: &str, values: &[f64], limit: f64, unit: &'static str) -> Result<(), ParameterError> {
    for (place, value) in values.iter().enumerate() {
        check(&format!("{key}[{place}]"), *value, 0.0, limit, unit)?;
    }
    Ok(())
}
