//! How far a signal moves from sample to sample.

use ferntast_identification::numerics::statistics::quantile;

/// Steps from sample to sample, of those that are none alone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Steps {
    /// All but one in a hundred are no larger.
    pub(super) usual: f64,
    /// Half of them are no larger.
    pub(super) middle: f64,
    /// The smallest.
    pub(super) least: f64,
}

impl Steps {
    /// Of these values; zeros where they never change.
    pub(super) fn of(values: &[f64]) -> Self {
        let steps = values.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        let mut steps: Vec<f64> = steps.filter(|step| *step > 0.0).collect();
        let mut at = |share| quantile(&mut steps, share, f64::total_cmp).unwrap_or(0.0);
        Self {
            usual: at(0.99),
            middle: at(0.5),
            least: at(0.0),
        }
    }
}
