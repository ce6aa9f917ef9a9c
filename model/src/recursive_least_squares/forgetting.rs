//! How what was learned long ago loses weight.

use serde::{Deserialize, Serialize};

use crate::{ParameterError, check};

/// Rule by which old samples are forgotten.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Forgetting {
    /// All samples count alike.
    None,
    /// Weight λⁿ after n samples, in all directions. Winds up: where the motion
    /// tells nothing, the covariance grows by 1/λ a sample until it is cut off.
    /// Here for comparison.
    Exponential {
        /// λ, 0.5 … 1 \[1\].
        factor: f64,
    },
    /// λ falls with the error, such that the information kept is that of
    /// `memory` samples: λ = 1 − w e² / ((1 + ζ) σ² memory), ζ = φᵀPφ, after
    /// Fortescue, Kershenbaum, Ydstie, "Implementation of self-tuning
    /// regulators with variable forgetting factors", Automatica 17(6), 1981.
    ///
    /// The weight w = min(1, ζ memory / n)² checks the excitation: in steady
    /// motion ζ is about n / memory for n parameters; at rest ζ goes as one over
    /// the number of samples, and the sum of all that is forgotten converges. Forgetting along φ only (Kulhavý 1987; Cao
    /// and Schwartz 2000) does not wind up either, but after a step in one of
    /// two correlated parameters it still was a third off when this rule had
    /// arrived.
    Variable {
        /// N₀ \[samples\].
        memory: f64,
        /// Smallest λ \[1\].
        least: f64,
    },
}

impl Default for Forgetting {
    fn default() -> Self {
        Self::Variable {
            memory: 1000.0,
            least: 0.95,
        }
    }
}

impl Forgetting {
    /// λ for an error e before the update, with ζ = φᵀPφ, the noise's variance
    /// σ² \[unit of y squared\] and the number of parameters.
    #[must_use]
    pub fn factor(&self, error: f64, zeta: f64, noise_variance: f64, parameters: usize) -> f64 {
        match *self {
            Self::None => 1.0,
            Self::Exponential { factor } => factor,
            Self::Variable { memory, least } => {
                let weight = (zeta * memory / parameters as f64).min(1.0).powi(2);
                let share = weight * error * error / ((1.0 + zeta) * noise_variance * memory);
                (1.0 - share).clamp(least, 1.0)
            }
        }
    }

    /// Number of samples \[1\] that it remembers; infinite without forgetting.
    #[must_use]
    pub fn memory(&self) -> f64 {
        match *self {
            Self::None => f64::INFINITY,
            Self::Exponential { factor } => 1.0 / (1.0 - factor).max(f64::MIN_POSITIVE),
            Self::Variable { memory, .. } => memory,
        }
    }

    /// Checks every value against its bounds.
    ///
    /// # Errors
    ///
    /// The first value that is out of bounds.
    pub fn validate(&self) -> Result<(), ParameterError> {
        match *self {
            Self::None => Ok(()),
            Self::Exponential { factor } => check("factor", factor, 0.5, 1.0, "-"),
            Self::Variable { memory, least } => {
                check("memory", memory, 2.0, 1e9, "samples")?;
                check("least", least, 0.5, 1.0, "-")
            }
        }
    }
}
