//! Recursive least squares: y = φᵀθ + e, one sample after the other.
//!
//! The covariance is kept in factors (UD), bounded by what was known at the
//! start, and forgets by a rule of choice ([`Forgetting`]). An update
//! allocates nothing, and whatever it is given, the estimate stays finite.

mod factor;
mod forgetting;

pub use forgetting::Forgetting;

use factor::Factor;

/// Share by which the running variance and correlation of the error follow,
/// at the slowest: they remember this many samples.
const ERROR_MEMORY: f64 = 2000.0;
/// Neighbouring errors more alike than this are as good as one.
const MAX_CORRELATED: f64 = 0.98;

/// What is known of a parameter before the first sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prior {
    /// Value to start from.
    pub value: f64,
    /// Standard deviation of that value. The estimate is never less certain.
    pub std_dev: f64,
    /// Smallest value allowed.
    pub lower: f64,
    /// Largest value allowed.
    pub upper: f64,
}

impl Prior {
    /// A value without bounds.
    #[must_use]
    pub const fn unbounded(value: f64, std_dev: f64) -> Self {
        Self {
            value,
            std_dev,
            lower: f64::NEG_INFINITY,
            upper: f64::INFINITY,
        }
    }
}

/// Why an estimator cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PriorError {
    /// There is nothing to estimate.
    #[error("no parameter to estimate; name at least one")]
    Empty,
    /// A prior is not usable.
    #[error(
        "prior of parameter {index}: value {value}, standard deviation {std_dev}, bounds {lower} … {upper}; \
         the value must lie within the bounds and the standard deviation above zero, both finite"
    )]
    Prior {
        /// Which parameter, from 0.
        index: usize,
        /// As given.
        value: f64,
        /// As given.
        std_dev: f64,
        /// As given.
        lower: f64,
        /// As given.
        upper: f64,
    },
    /// The noise is not a positive, finite number.
    #[error("standard deviation of the noise is {0}; it must be finite and above zero")]
    Noise(f64),
}

/// What an update made of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Update {
    /// It was learned from.
    Learned {
        /// e = y − φᵀθ with the θ before the update \[unit of y\].
        error: f64,
        /// λ \[1\].
        factor: f64,
    },
    /// It holds a number that is not finite or whose square is not, or is of
    /// another length: nothing changed.
    Refused,
    /// The covariance had become unusable and starts over from the priors;
    /// the estimate is kept.
    Restarted,
}

/// The estimator.
#[derive(Clone, Debug)]
pub struct RecursiveLeastSquares {
    priors: Box<[Prior]>,
    /// Variances at the start, in units of the noise's variance.
    start: Box<[f64]>,
    theta: Box<[f64]>,
    at_bound: Box<[bool]>,
    covariance: Factor,
    forgetting: Forgetting,
    noise_variance: f64,
    /// Running mean of e²/(1 + ζ) \[unit of y squared\].
    error_variance: f64,
    /// Running mean of e_t e_{t−1}, each over √(1 + ζ).
    error_product: f64,
    last_error: f64,
    samples: u64,
}

impl RecursiveLeastSquares {
    /// Starts from `priors`; `noise` is the expected standard deviation of e
    /// \[unit of y\].
    ///
    /// # Errors
    ///
    /// See [`PriorError`].
    pub fn new(priors: &[Prior], noise: f64, forgetting: Forgetting) -> Result<Self, PriorError> {
        if priors.is_empty() {
            return Err(PriorError::Empty);
        }
        if !(noise.is_finite() && noise > 0.0) {
            return Err(PriorError::Noise(noise));
        }
        for (index, prior) in priors.iter().enumerate() {
            let usable = prior.value.is_finite()
                && prior.std_dev.is_finite()
                && prior.std_dev > 0.0
                && (prior.lower..=prior.upper).contains(&prior.value);
            if !usable {
                return Err(PriorError::Prior {
                    index,
                    value: prior.value,
                    std_dev: prior.std_dev,
                    lower: prior.lower,
                    upper: prior.upper,
                });
            }
        }
        let start: Box<[f64]> = priors
            .iter()
            .map(|prior| (prior.std_dev / noise).powi(2))
            .collect();
        Ok(Self {
            theta: priors.iter().map(|prior| prior.value).collect(),
            at_bound: vec![false; priors.len()].into_boxed_slice(),
            covariance: Factor::diagonal(&start),
            start,
            priors: priors.into(),
            forgetting,
            noise_variance: noise * noise,
            error_variance: noise * noise,
            error_product: 0.0,
            last_error: 0.0,
            samples: 0,
        })
    }

    /// Learns from one sample: regressor φ and measurement y.
    pub fn update(&mut self, phi: &[f64], y: f64) -> Update {
        let finite = y.is_finite() && phi.iter().all(|x| x.is_finite());
        if phi.len() != self.theta.len() || !finite {
            return Update::Refused;
        }
        let error = y - self.predict(phi);
        let zeta = self.covariance.look_along(phi);
        if !((zeta * zeta).is_finite() && (error * error).is_finite()) {
            return Update::Refused;
        }
        let factor = self
            .forgetting
            .factor(error, zeta, self.noise_variance, self.theta.len());
        let zeta_forgotten = self.forget(zeta, factor);
        let gain = error / (1.0 + zeta_forgotten);
        for (theta, direction) in self.theta.iter_mut().zip(self.covariance.projected()) {
            *theta += direction * gain;
        }
        self.covariance.measure(1.0);
        if !self.covariance.is_finite() {
            self.covariance.reset(&self.start);
            return Update::Restarted;
        }
        self.keep_within_bounds();
        self.note(error / (1.0 + zeta).sqrt());
        self.samples += 1;
        Update::Learned { error, factor }
    }

    /// φᵀθ; zero for what φ leaves out.
    #[must_use]
    pub fn predict(&self, phi: &[f64]) -> f64 {
        phi.iter().zip(&self.theta).map(|(x, t)| x * t).sum()
    }

    /// θ.
    #[must_use]
    pub fn estimate(&self) -> &[f64] {
        &self.theta
    }

    /// Standard error of parameter `index`, from the errors that were seen,
    /// their correlation from sample to sample included. Never above the
    /// prior's where the errors are what was expected.
    #[must_use]
    pub fn std_error(&self, index: usize) -> f64 {
        let correlation = self.error_correlation();
        let inflation = (1.0 + correlation) / (1.0 - correlation);
        (self.variance(index) * self.error_variance * inflation).sqrt()
    }

    /// Standard deviation of parameter `index` by the covariance alone, over
    /// the prior's: 1 at the start; above 1 the estimator has wound up \[1\].
    #[must_use]
    pub fn uncertainty(&self, index: usize) -> f64 {
        let start = self.start.get(index).copied().unwrap_or(1.0);
        (self.variance(index) / start).sqrt()
    }

    /// Share of the prior's variance that the samples have removed: 0 where
    /// they told nothing, towards 1 where they told all \[1\].
    #[must_use]
    pub fn excitation(&self, index: usize) -> f64 {
        let start = self.start.get(index).copied().unwrap_or(1.0);
        (1.0 - self.variance(index) / start).clamp(0.0, 1.0)
    }

    /// Whether parameter `index` is held at a bound.
    #[must_use]
    pub fn at_bound(&self, index: usize) -> bool {
        self.at_bound.get(index).copied().unwrap_or(false)
    }

    /// Standard deviation of the error, forgotten slowly \[unit of y\].
    #[must_use]
    pub fn error_std_dev(&self) -> f64 {
        self.error_variance.sqrt()
    }

    /// Correlation of neighbouring errors, 0 … 0.98 \[1\].
    #[must_use]
    pub fn error_correlation(&self) -> f64 {
        (self.error_product / self.error_variance.max(f64::MIN_POSITIVE)).clamp(0.0, MAX_CORRELATED)
    }

    /// Samples learned from.
    #[must_use]
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// P_ii in units of the noise's variance.
    fn variance(&self, index: usize) -> f64 {
        if index < self.theta.len() {
            self.covariance.at(index, index)
        } else {
            0.0
        }
    }

    /// Widens P by what is forgotten; returns ζ as it is then.
    fn forget(&mut self, zeta: f64, factor: f64) -> f64 {
        let growth = match self.forgetting {
            Forgetting::Exponential { .. } => 1.0 / factor,
            Forgetting::Variable { .. } if factor < 1.0 => (1.0 / factor).min(self.room()),
            Forgetting::None | Forgetting::Variable { .. } => 1.0,
        };
        self.covariance.scale(growth);
        zeta * growth
    }

    /// By how much P may grow before a parameter is less certain than at the
    /// start; 1 or more.
    fn room(&self) -> f64 {
        (0..self.start.len())
            .map(|i| self.start[i] / self.covariance.at(i, i).max(f64::MIN_POSITIVE))
            .fold(f64::INFINITY, f64::min)
            .max(1.0)
    }

    /// Moves an estimate that left its bounds onto them, and the others along
    /// with it as their covariance says.
    fn keep_within_bounds(&mut self) {
        for i in 0..self.theta.len() {
            let Prior { lower, upper, .. } = self.priors[i];
            let target = self.theta[i].clamp(lower, upper);
            let excess = self.theta[i] - target;
            if excess == 0.0 {
                continue;
            }
            let own = self.covariance.at(i, i);
            if own > 0.0 {
                for j in 0..self.theta.len() {
                    self.theta[j] -= self.covariance.at(j, i) / own * excess;
                }
            }
            self.theta[i] = target;
        }
        for (i, prior) in self.priors.iter().enumerate() {
            let theta = self.theta[i].clamp(prior.lower, prior.upper);
            self.theta[i] = theta;
            self.at_bound[i] = theta == prior.lower || theta == prior.upper;
        }
    }

    fn note(&mut self, error: f64) {
        // The expected variance counts as ten samples.
        let memory = ERROR_MEMORY.min(self.forgetting.memory());
        let share = 1.0 / (self.samples as f64 + 10.0).min(memory);
        self.error_variance += share * (error * error - self.error_variance);
        self.error_product += share * (error * self.last_error - self.error_product);
        self.last_error = error;
    }
}

#[cfg(test)]
mod tests;
