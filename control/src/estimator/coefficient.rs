//! Equation (6) on line: F_T = b_0T · |F_N|, by least squares with forgetting.

use super::systematic::{ERRORS, SplitErrors};

/// The Coulomb coefficient b_0T of one surface and its standard error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CoefficientEstimator {
    count: f64,
    normal_normal: f64,
    normal_tangential: f64,
    tangential_tangential: f64,
    /// For each systematic error sums of F_N times that of F_N, and of F_T.
    systematic: SplitErrors,
    /// How many samples in a row tell the same, as the filter makes them alike.
    alike: f64,
}

/// A value with its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficient {
    /// b_0T \[-\]; zero before it is identified.
    pub value: f64,
    /// Its standard error \[-\], of noise and of what is wrong all the time together;
    /// infinite before it is identified.
    pub error: f64,
}

impl Coefficient {
    /// Nothing is known yet.
    pub const UNKNOWN: Coefficient = Coefficient {
        value: 0.0,
        error: f64::INFINITY,
    };
}

impl CoefficientEstimator {
    /// Takes in one sample of sliding: `normal` F_N and `tangential` F_T
    /// \[N\] with their systematic `errors` \[N\], `dt` \[s\] after the last one, made
    /// alike by a filter with `cut_off` \[Hz\]; old samples fade with time constant
    /// `memory` \[s\].
    pub(super) fn step(
        &mut self,
        normal: f64,
        tangential: f64,
        errors: &SplitErrors,
        dt: f64,
        memory: f64,
        cut_off: f64,
    ) {
        let keep = memory / (memory + dt);
        self.count = keep * self.count + 1.0;
        self.normal_normal = keep * self.normal_normal + normal * normal;
        self.normal_tangential = keep * self.normal_tangential + normal.abs() * tangential;
        self.tangential_tangential = keep * self.tangential_tangential + tangential * tangential;
        for (sums, errors) in self.systematic.iter_mut().zip(errors) {
            sums[0] = keep * sums[0] + normal.abs() * errors[0];
            sums[1] = keep * sums[1] + normal.abs() * errors[1];
        }
        // Behind a low-pass of bandwidth f there are 2 f independent samples a second.
        self.alike = (1.0 / (2.0 * cut_off * dt)).max(1.0);
    }

    /// The coefficient as it is known now.
    pub fn coefficient(&self) -> Coefficient {
        let independent = self.count / self.alike;
        if independent < 3.0 || self.normal_normal <= 0.0 {
            return Coefficient::UNKNOWN;
        }
        let value = self.normal_tangential / self.normal_normal;
        let residual = (self.tangential_tangential - value * self.normal_tangential).max(0.0);
        let variance = residual / self.count * independent / (independent - 1.0);
        // Of the first order in the errors: δb = Σ F_N (δF_T − b δF_N) / Σ F_N².
        let systematic = (0..ERRORS).map(|k| {
            let [normal, tangential] = self.systematic[k];
            ((tangential - value * normal) / self.normal_normal).powi(2)
        });
        let random = variance * self.alike / self.normal_normal;
        Coefficient {
            value,
            error: (random + systematic.sum::<f64>()).sqrt(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NO_ERRORS: SplitErrors = [[0.0; 2]; ERRORS];

    /// A zero of 0.5 N along the normal of 10 N makes 5 % of the coefficient; along the
    /// tangent it cancels out to and fro, as does the contour's turn.
    #[test]
    fn what_is_wrong_all_the_time_does_not_average_out() {
        let mut estimator = CoefficientEstimator::default();
        for k in 0..10_000 {
            let direction = if k / 100 % 2 == 0 { 1.0 } else { -1.0 };
            let mut errors = NO_ERRORS;
            errors[0] = [0.5, direction * 0.5];
            errors[4] = [direction * 0.1, direction * 0.35];
            estimator.step(10.0, 3.0, &errors, 1e-3, 1e9, 500.0);
        }
        let found = estimator.coefficient();
        assert!((found.error - 0.05 * 0.3).abs() < 1e-4, "{found:?}");
    }

    #[test]
    fn nothing_is_known_before_sliding() {
        assert_eq!(
            CoefficientEstimator::default().coefficient(),
            Coefficient::UNKNOWN
        );
    }

    #[test]
    fn it_finds_the_slope_and_its_error() {
        let mut estimator = CoefficientEstimator::default();
        // Residuals of exactly ±1 N at 10 N, independent: error = 1 / (10 √n).
        for k in 0..1000 {
            let disturbance = if k % 2 == 0 { 1.0 } else { -1.0 };
            estimator.step(10.0, 3.0 + disturbance, &NO_ERRORS, 1e-3, 1e9, 500.0);
        }
        let found = estimator.coefficient();
        assert!((found.value - 0.3).abs() < 1e-9);
        assert!(
            (found.error - 0.1 / 1000_f64.sqrt()).abs() < 1e-5,
            "{found:?}"
        );
    }

    #[test]
    fn it_forgets() {
        let mut estimator = CoefficientEstimator::default();
        for k in 0..4000 {
            let slope = if k < 2000 { 0.2 } else { 0.4 };
            estimator.step(10.0, slope * 10.0, &NO_ERRORS, 1e-3, 0.2, 40.0);
        }
        assert!((estimator.coefficient().value - 0.4).abs() < 1e-4);
    }
}
