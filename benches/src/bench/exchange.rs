//! Another truth under the same noise.

/// `logged`, of which the truth was `truth`, as it would be if that were `other`:
/// noise and rounding stay. All three are of one length and in one unit.
pub(crate) fn exchange(logged: &[f64], truth: &[f64], other: &[f64]) -> Vec<f64> {
    let each = logged.iter().zip(truth).zip(other);
    each.map(|((logged, truth), other)| logged + (other - truth))
        .collect()
}
