//! What siblings do together.

/// Residuals beyond so many standard deviations count as this many (Huber 1964: 95 % of
/// the efficiency at the normal distribution).
const BOUND: f64 = 1.345;
/// Variance of such a location beside that of the mean.
const LOSS: f64 = 1.05;
const ROUNDS: usize = 8;

/// A robust location of `(value, variance)`, and its variance. `None` without a value.
pub(super) fn location(values: &[(f64, f64)]) -> Option<(f64, f64)> {
    let information: f64 = values.iter().map(|(_, variance)| 1.0 / variance).sum();
    let mut center = median(values, information)?;
    let deviations: Vec<f64> = values.iter().map(|(_, variance)| variance.sqrt()).collect();
    for _ in 0..ROUNDS {
        let (mut sum, mut weights) = (0.0, 0.0);
        for ((value, variance), deviation) in values.iter().zip(&deviations) {
            let u = ((value - center) / deviation).abs();
            let weight = if u > BOUND { BOUND / u } else { 1.0 } / variance;
            sum += weight * value;
            weights += weight;
        }
        center = sum / weights;
    }
    Some((center, LOSS / information))
}

/// The median by weights of 1 / variance.
fn median(values: &[(f64, f64)], information: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut passed = 0.0;
    let middle = sorted.iter().find(|(_, variance)| {
        passed += 1.0 / variance;
        passed >= 0.5 * information
    });
    middle.map(|(value, _)| *value)
}

/// The middle of `values`; `None` without one.
pub(super) fn middle(values: impl Iterator<Item = f64>) -> Option<f64> {
    let equal: Vec<(f64, f64)> = values.map(|value| (value, 1.0)).collect();
    median(&equal, equal.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_of_three_that_runs_away_does_not_take_the_others_along() {
        for far in [10.0, 1e3, 1e6] {
            let values = [(0.0, 1.0), (0.2, 1.0), (far, 1.0)];
            let (center, variance) = location(&values).expect("a location");
            // Bounded by 1.345 standard deviations shared by two.
            assert!((0.1..0.1 + 0.7).contains(&center), "{center}");
            assert!((0.33..0.36).contains(&variance), "{variance}");
        }
        assert_eq!(location(&[]), None);
    }

    #[test]
    fn of_values_that_agree_it_is_the_weighted_mean() {
        let values = [(1.0, 0.1), (1.1, 0.1), (1.3, 0.4)];
        let (center, _) = location(&values).expect("a location");
        let mean = (1.0 / 0.1 + 1.1 / 0.1 + 1.3 / 0.4) / (2.0 / 0.1 + 1.0 / 0.4);
        assert!((center - mean).abs() < 1e-9, "{center} {mean}");
    }
}
