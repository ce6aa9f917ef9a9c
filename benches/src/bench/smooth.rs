//! The filter by which a bench looks at its own recordings.

use std::f64::consts::{LN_2, TAU};

use super::LOG_PERIOD;

/// Cut-off (−3 dB) of the low-pass on every channel \[Hz\].
const CUT_OFF: f64 = 8.0;

/// Gaussian low-pass forwards and backwards in time at once; at the ends over
/// what there is.
pub(crate) fn smooth(values: &[f64]) -> Vec<f64> {
    let deviation = LN_2.sqrt() / (TAU * CUT_OFF) / LOG_PERIOD;
    let reach = (4.0 * deviation).ceil() as usize;
    let weights: Vec<f64> = (0..=reach)
        .map(|step| (-0.5 * (step as f64 / deviation).powi(2)).exp())
        .collect();
    (0..values.len())
        .map(|index| {
            let from = index.saturating_sub(reach);
            let near = values[from..].iter().take(index + reach + 1 - from);
            let (mut sum, mut weight) = (0.0, 0.0);
            for (offset, value) in near.enumerate() {
                let w = weights[(from + offset).abs_diff(index)];
                sum += w * value;
                weight += w;
            }
            sum / weight
        })
        .collect()
}

/// Central differences \[1/s\]; at the ends 0.
pub(crate) fn differentiate(values: &[f64]) -> Vec<f64> {
    let mut rates = vec![0.0; values.len()];
    for (rate, around) in rates.iter_mut().skip(1).zip(values.windows(3)) {
        *rate = (around[2] - around[0]) / (2.0 * LOG_PERIOD);
    }
    rates
}

/// Root of the mean square; 0 of nothing.
pub(crate) fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, n), x| (sum + x * x, n + 1.0));
    if count > 0.0 {
        f64::sqrt(sum / count)
    } else {
        0.0
    }
}
