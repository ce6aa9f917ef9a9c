//! Periods of the residual over position.

use crate::design::{Design, PreparedModel};
use crate::effects::EffectHandle;

/// Bins of position for each period of the finest ripple.
const BINS_A_PERIOD: f64 = 8.0;
/// Largest number of bins of position.
const MAX_BINS: usize = 1 << 15;

/// The strongest wave numbers k \[1/rad\] of the residual over position within
/// the bounds of a periodic `effect`, at most `count`, strongest first.
///
/// The residual (each session with parameters of its own) is averaged in narrow
/// bins of position, apart for slow and fast rows, because the filter takes the
/// ripple out of fast ones; then sine and cosine are projected on the bins.
#[must_use]
pub fn peaks(
    prepared: &PreparedModel,
    design: &Design,
    effect: &EffectHandle,
    count: usize,
) -> Vec<f64> {
    let bounds = effect.bounds(&prepared.facts);
    let Some([lowest, highest]) = bounds.first().copied() else {
        return Vec::new();
    };
    let range = prepared.facts.travel();
    if !(range > 0.0 && highest > lowest) {
        return Vec::new();
    }
    let finest = std::f64::consts::TAU / highest;
    let bins = ((range / finest * BINS_A_PERIOD).ceil() as usize).clamp(64, MAX_BINS);
    let highest = highest.min(std::f64::consts::TAU * bins as f64 / (4.0 * range));
    let width = range / bins as f64;
    let mut sums = vec![(0.0, 0.0); bins];
    for (session, signals) in design.sessions.iter().zip(&prepared.sessions) {
        let residual = session.own_residual();
        let mut speeds: Vec<f64> = signals
            .rows
            .iter()
            .map(|at| signals.points[*at].velocity.abs())
            .collect();
        let typical = crate::numerics::statistics::quantile_or_zero(&mut speeds, 0.5).max(1e-12);
        for (r, at) in residual.iter().zip(&signals.rows) {
            let point = &signals.points[*at];
            let bin = ((point.position - prepared.facts.position[0]) / width).floor();
            if bin >= 0.0 && (bin as usize) < bins {
                let weight = 1.0 / (1.0 + (point.velocity / typical).powi(2));
                let (sum, weights) = &mut sums[bin as usize];
                *sum += weight * r;
                *weights += weight;
            }
        }
    }
    let step = std::f64::consts::PI / range / 2.0;
    let waves = ((highest - lowest) / step).floor() as usize + 1;
    let power: Vec<f64> = (0..waves)
        .map(|i| strength(&sums, width, lowest + step * i as f64))
        .collect();
    let mut maxima: Vec<usize> = (0..waves)
        .filter(|i| {
            power[*i] >= power[i.saturating_sub(1)] && power[*i] >= power[(i + 1).min(waves - 1)]
        })
        .collect();
    maxima.sort_by(|a, b| power[*b].total_cmp(&power[*a]));
    maxima
        .into_iter()
        .take(count)
        .map(|i| {
            // Sharpen on a grid ten times finer.
            (-10..=10)
                .map(|j| lowest + step * (i as f64 + 0.1 * f64::from(j)))
                .filter(|k| *k > 0.0)
                .max_by(|a, b| strength(&sums, width, *a).total_cmp(&strength(&sums, width, *b)))
                .unwrap_or(lowest)
        })
        .collect()
}

/// Number of wave numbers that the search goes through, for the correction of
/// p-values.
#[must_use]
pub fn tried(prepared: &PreparedModel, effect: &EffectHandle) -> usize {
    let bounds = effect.bounds(&prepared.facts);
    bounds.first().map_or(0, |b| {
        ((b[1] - b[0]) * prepared.facts.travel() / std::f64::consts::PI).clamp(0.0, MAX_BINS as f64)
            as usize
    })
}

/// Weighted share of the bins' sum of squares that sine and cosine of wave
/// number `k` explain, per unit.
fn strength(sums: &[(f64, f64)], width: f64, k: f64) -> f64 {
    let (step_sine, step_cosine) = (k * width).sin_cos();
    let (mut sine, mut cosine) = (0.0, 1.0);
    let (mut a, mut b, mut ss, mut cc, mut sc) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (i, (sum, weight)) in sums.iter().enumerate() {
        if i % 256 == 0 {
            (sine, cosine) = (k * width * i as f64).sin_cos();
        }
        a += sum * sine;
        b += sum * cosine;
        ss += weight * sine * sine;
        cc += weight * cosine * cosine;
        sc += weight * sine * cosine;
        (sine, cosine) = (
            sine * step_cosine + cosine * step_sine,
            cosine * step_cosine - sine * step_sine,
        );
    }
    let determinant = ss * cc - sc * sc;
    if determinant <= 1e-9 * ss * cc {
        return 0.0;
    }
    (a * a * cc - 2.0 * a * b * sc + b * b * ss) / determinant
}
