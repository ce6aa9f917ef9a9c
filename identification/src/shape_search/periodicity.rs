//! Periods of the residual over position.

use crate::design::{Design, PreparedModel};
use crate::effects::EffectHandle;
use crate::numerics::waves::strengths;

/// Bins of position for each period of the finest ripple.
const BINS_A_PERIOD: f64 = 8.0;
/// Wave numbers looked at together.
const LANES: usize = 4;
/// Largest number of bins of position.
const MAX_BINS: usize = 1 << 15;

/// The strongest wave numbers k \[1/rad\] of the residual over position within
/// the bounds of a periodic `effect`, at most `count`, strongest first.
///
/// The residual (each session with parameters of its own) is averaged in narrow
/// bins of position, apart for slow and fast rows, because the filter takes the
/// ripple out of fast ones; then sine and cosine are projected on the bins. Of an effect that
/// goes with the load it is the residual's slope over the load that is averaged.
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
    let goes_with_load = effect.row().own_signals.names.contains(&"load");
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
                let factor = if goes_with_load { point.load } else { 1.0 };
                let (sum, weights) = &mut sums[bin as usize];
                *sum += weight * factor * r;
                *weights += weight * factor * factor;
            }
        }
    }
    let step = std::f64::consts::PI / range / 2.0;
    let waves = ((highest - lowest) / step).floor() as usize + 1;
    let wave = |i: usize| lowest + step * i as f64;
    let mut power: Vec<f64> = (0..waves.div_ceil(LANES))
        .flat_map(|block| {
            let lanes: [f64; LANES] = std::array::from_fn(|lane| wave(block * LANES + lane));
            strengths(&sums, width, lanes)
        })
        .collect();
    power.truncate(waves);
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
            let finer: [f64; 21] =
                std::array::from_fn(|j| lowest + step * (i as f64 + 0.1 * (j as f64 - 10.0)));
            let strong = strengths(&sums, width, finer);
            finer
                .into_iter()
                .zip(strong)
                .filter(|(k, _)| *k > 0.0)
                .max_by(|(_, a), (_, b)| a.total_cmp(b))
                .map_or(lowest, |(k, _)| k)
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
