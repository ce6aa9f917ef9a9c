//! The same rows, one after the other.

use ferntast_model::recursive_least_squares::{
    Forgetting, Prior, PriorError, RecursiveLeastSquares, Update,
};

use super::{Estimate, Row};

/// An estimate has converged when it stays this near to its off-line value from then on \[1\].
const CONVERGED: f64 = 0.10;

/// Course of the two parameters of one regression on line.
#[derive(Clone, Debug, PartialEq)]
pub struct OnLine {
    /// Estimates after each row.
    pub track: Vec<Track>,
}

/// Estimates at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Track {
    /// Since the start \[s\].
    pub time: f64,
    /// Both estimates.
    pub values: [f64; 2],
    /// Their standard errors.
    pub std_errors: [f64; 2],
    /// Standard deviations by the covariance alone, over those at the start:
    /// above 1 the estimator has wound up \[1\].
    pub uncertainty: [f64; 2],
}

/// Runs recursive least squares over rows, from zero; `scales` are the priors'
/// standard deviations, `noise` the expected residual \[Nm\].
///
/// # Errors
///
/// Scales or noise that are not positive.
pub fn on_line(
    rows: &[Row],
    scales: [f64; 2],
    noise: f64,
    forgetting: Forgetting,
) -> Result<OnLine, PriorError> {
    let priors = scales.map(|scale| Prior::unbounded(0.0, scale));
    let mut estimator = RecursiveLeastSquares::new(&priors, noise, forgetting)?;
    let mut track = Vec::with_capacity(rows.len());
    for row in rows {
        if let Update::Refused = estimator.update(&row.phi, row.measured) {
            continue;
        }
        let std_errors = [0, 1].map(|i| estimator.std_error(i));
        track.push(Track {
            time: row.time,
            values: [0, 1].map(|i| estimator.estimate().get(i).copied().unwrap_or(0.0)),
            std_errors,
            uncertainty: [0, 1].map(|i| estimator.uncertainty(i)),
        });
    }
    Ok(OnLine { track })
}

impl OnLine {
    /// Largest standard deviation that the covariance gave parameter `index`
    /// after time `from` \[s\], over that at the start; above 1 the estimator
    /// has wound up \[1\].
    #[must_use]
    pub fn wind_up(&self, index: usize, from: f64) -> f64 {
        let all = self.track.iter().filter(|track| track.time >= from);
        all.filter_map(|track| track.uncertainty.get(index).copied())
            .fold(0.0, f64::max)
    }

    /// Time \[s\] from which parameter `index` stays within a tenth of its
    /// off-line value, but for moments that add up to less than a hundredth of
    /// the rest; `None` if it never does.
    #[must_use]
    pub fn convergence_time(&self, index: usize, off_line: Estimate) -> Option<f64> {
        let far = |track: &Track| {
            let value = track.values.get(index).copied().unwrap_or(f64::NAN);
            (value - off_line.value).abs() > CONVERGED * off_line.value.abs()
        };
        let mut outside = 0_usize;
        let mut converged = None;
        for (counted, track) in self.track.iter().rev().enumerate() {
            outside += usize::from(far(track));
            if outside * 100 > counted + 1 {
                break;
            }
            converged = Some(track.time);
        }
        converged
    }

    /// Mean and standard deviation of parameter `index` after time `from` \[s\].
    #[must_use]
    pub fn steady(&self, index: usize, from: f64) -> Option<(f64, f64)> {
        let values: Vec<f64> = self
            .track
            .iter()
            .filter(|track| track.time >= from)
            .filter_map(|track| track.values.get(index).copied())
            .collect();
        if values.is_empty() {
            return None;
        }
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / count;
        Some((mean, variance.sqrt()))
    }
}
