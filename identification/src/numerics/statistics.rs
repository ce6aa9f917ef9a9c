//! Quantiles and tests of significance.

use std::cmp::Ordering;

use nalgebra::{DMatrix, DVector};

use super::gram::pseudo_inverse;

/// The quantile of n numbers at `share` (0: the least, 1: the largest): the one
/// of rank round((n − 1) · share), not interpolated, so that the median of an
/// even count is the larger of the middle two. `None` of no numbers, which are
/// left in another order.
pub fn quantile<T: Copy>(
    numbers: &mut [T],
    share: f64,
    order: impl FnMut(&T, &T) -> Ordering,
) -> Option<T> {
    let last = numbers.len().checked_sub(1)?;
    let rank = (last as f64 * share).round() as usize;
    Some(*numbers.select_nth_unstable_by(rank.min(last), order).1)
}

/// The [`quantile()`] of real numbers; 0 of none.
pub(crate) fn quantile_or_zero(numbers: &mut [f64], share: f64) -> f64 {
    quantile(numbers, share, f64::total_cmp).unwrap_or(0.0)
}

/// Probability that an F-distributed number with `numerator` and
/// `denominator` degrees of freedom exceeds `f`.
#[must_use]
pub fn f_tail(f: f64, numerator: f64, denominator: f64) -> f64 {
    if !f.is_finite() || f <= 0.0 || denominator <= 0.0 || numerator <= 0.0 {
        return if f == f64::INFINITY { 0.0 } else { 1.0 };
    }
    let x = denominator / (denominator + numerator * f);
    puruspe::betai(0.5 * denominator, 0.5 * numerator, x)
}

/// The number that a t-distributed one with this many degrees of `freedom` is below
/// with `probability` (a half or more).
#[must_use]
pub fn t_quantile(probability: f64, freedom: f64) -> f64 {
    // t² is F-distributed with one degree of freedom above.
    let beyond = |t: f64| 0.5 * f_tail(t * t, 1.0, freedom);
    let (mut low, mut high) = (0.0, 1.0);
    while beyond(high) > 1.0 - probability && high < 1e6 {
        high *= 2.0;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        match beyond(middle) > 1.0 - probability {
            true => low = middle,
            false => high = middle,
        }
    }
    0.5 * (low + high)
}

/// Wald test that all coefficients are zero, from the estimates with one of
/// G clusters left out each (jackknife, CR3): it allows for any correlation
/// and any variance within a cluster.
///
/// Of the mean of G clusters the Wald statistic W is Hotelling's T² (1931): (G − m) W / (m (G − 1))
/// is F-distributed with m and G − m degrees of freedom, whose p-value is returned.
#[must_use]
pub fn jackknife_wald(estimate: &DVector<f64>, without: &[DVector<f64>]) -> f64 {
    let m = estimate.len();
    let clusters = without.len() as f64;
    let freedom = clusters - m as f64;
    if m == 0 || freedom < 1.0 {
        return 1.0;
    }
    let covariance = jackknife_covariance(estimate, without);
    let (inverse, _) = pseudo_inverse(&covariance);
    let wald = (estimate.transpose() * inverse * estimate)[(0, 0)];
    let ratio = wald * freedom / (m as f64 * (clusters - 1.0));
    f_tail(ratio, m as f64, freedom)
}

/// (G−1)/G Σ (c₍₋ᵢ₎ − c)(c₍₋ᵢ₎ − c)ᵀ.
#[must_use]
pub fn jackknife_covariance(estimate: &DVector<f64>, without: &[DVector<f64>]) -> DMatrix<f64> {
    let m = estimate.len();
    let mut covariance = DMatrix::zeros(m, m);
    for other in without {
        let difference = other - estimate;
        covariance += &difference * difference.transpose();
    }
    let count = without.len() as f64;
    covariance * ((count - 1.0) / count.max(1.0))
}

/// Mean and its standard error.
#[must_use]
pub fn mean_error(numbers: &[f64]) -> (f64, f64) {
    let n = numbers.len() as f64;
    if n < 2.0 {
        return (numbers.first().copied().unwrap_or(0.0), f64::INFINITY);
    }
    let mean = numbers.iter().sum::<f64>() / n;
    let variance = numbers.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::recordings::noise;

    #[test]
    fn a_quantile_is_the_number_of_the_nearest_rank() {
        let mut numbers = [4, 1, 3, 2];
        for (share, expected) in [
            (0.0, 1),
            (0.16, 1),
            (0.17, 2),
            (0.5, 3),
            (0.83, 3),
            (1.0, 4),
        ] {
            assert_eq!(quantile(&mut numbers, share, i32::cmp), Some(expected));
        }
        assert_eq!(quantile(&mut [7.0], 0.99, f64::total_cmp), Some(7.0));
        assert_eq!(quantile(&mut [], 0.5, f64::total_cmp), None);
    }

    #[test]
    fn tail_of_f_agrees_with_tables() {
        // F(1, 5): 6.608 at 5 %; F(2, 10): 4.103 at 5 %, 7.559 at 1 %.
        assert!((f_tail(6.608, 1.0, 5.0) - 0.05).abs() < 1e-4);
        assert!((f_tail(4.103, 2.0, 10.0) - 0.05).abs() < 1e-4);
        assert!((f_tail(7.559, 2.0, 10.0) - 0.01).abs() < 1e-5);
    }

    #[test]
    fn quantiles_of_t_agree_with_tables() {
        for (freedom, expected) in [(1.0, 12.706), (5.0, 2.571), (11.0, 2.201), (1e6, 1.960)] {
            let found = t_quantile(0.975, freedom);
            assert!((found - expected).abs() < 1e-3, "{found} for {freedom}");
        }
    }

    #[test]
    fn jackknife_of_a_mean_is_its_standard_error() {
        let numbers = [1.0, 2.0, 4.0, 7.0];
        let mean = DVector::from_element(1, 3.5);
        let without: Vec<_> = (0..4)
            .map(|i| DVector::from_element(1, (14.0 - numbers[i]) / 3.0))
            .collect();
        let (_, error) = mean_error(&numbers);
        let covariance = jackknife_covariance(&mean, &without);
        assert!((covariance[(0, 0)].sqrt() - error).abs() < 1e-12);
    }

    /// The mean of twelve clusters in three dimensions, whose components go together. A rate of
    /// 5 % in 6000 trials has a standard error of 0.3 %; of W / m without Hotelling's factor, the
    /// rate would be that of F(3, 9) above 9/11 of its 5 % limit, 7.7 %.
    #[test]
    fn the_test_rejects_as_often_as_it_says() {
        const CLUSTERS: usize = 12;
        let mut noise = noise(1);
        let mut draw = || {
            let (a, b, c) = (noise(), noise(), noise());
            DVector::from_vec(vec![a, 3.0 * (0.6 * a + 0.8 * b), 0.1 * (b + c)])
        };
        let trials = 6000;
        let rejected = (0..trials).filter(|_| {
            let clusters: Vec<DVector<f64>> = (0..CLUSTERS).map(|_| draw()).collect();
            let sum: DVector<f64> = clusters.iter().sum();
            let each = clusters.iter();
            let without: Vec<DVector<f64>> = each
                .map(|own| (&sum - own) / (CLUSTERS as f64 - 1.0))
                .collect();
            jackknife_wald(&(sum / CLUSTERS as f64), &without) < 0.05
        });
        let rate = rejected.count() as f64 / f64::from(trials);
        assert!((0.04..0.06).contains(&rate), "{rate}");
    }
}
