//! Periods of the residual over position.

use crate::design::{Design, PreparedModel};
use crate::effects::EffectHandle;

/// Bins of position for each period of the finest ripple.
const BINS_A_PERIOD: f64 = 8.0;
/// Wave numbers looked at together.
const LANES: usize = 4;
/// Bins after which sine and cosine are computed anew.
const EXACT: usize = 256;
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

/// Sine and cosine of one wave number, turned on from bin to bin, and what they sum up to.
#[derive(Clone, Copy, Default)]
struct Wave {
    turn: (f64, f64),
    sine: f64,
    cosine: f64,
    a: f64,
    b: f64,
    ss: f64,
    cc: f64,
    sc: f64,
}

impl Wave {
    #[inline]
    fn add(&mut self, sum: f64, weight: f64) {
        let (sine, cosine) = (self.sine, self.cosine);
        let (step_sine, step_cosine) = self.turn;
        self.a += sum * sine;
        self.b += sum * cosine;
        self.ss += weight * sine * sine;
        self.cc += weight * cosine * cosine;
        self.sc += weight * sine * cosine;
        self.sine = sine * step_cosine + cosine * step_sine;
        self.cosine = cosine * step_cosine - sine * step_sine;
    }

    fn strength(&self) -> f64 {
        let Wave {
            a, b, ss, cc, sc, ..
        } = *self;
        let determinant = ss * cc - sc * sc;
        if determinant <= 1e-9 * ss * cc {
            return 0.0;
        }
        (a * a * cc - 2.0 * a * b * sc + b * b * ss) / determinant
    }
}

/// Weighted share of the bins' sum of squares that sine and cosine of each wave number
/// of `k` explain, per unit. Several at once: each is a chain of products that the processor
/// waits for, and does the others meanwhile.
fn strengths<const N: usize>(sums: &[(f64, f64)], width: f64, k: [f64; N]) -> [f64; N] {
    let mut waves = k.map(|k| Wave {
        turn: (k * width).sin_cos(),
        ..Wave::default()
    });
    for (block, sums) in sums.chunks(EXACT).enumerate() {
        let begin = (block * EXACT) as f64;
        for (wave, k) in waves.iter_mut().zip(k) {
            (wave.sine, wave.cosine) = (k * width * begin).sin_cos();
        }
        for (sum, weight) in sums {
            for wave in &mut waves {
                wave.add(*sum, *weight);
            }
        }
    }
    waves.map(|wave| wave.strength())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Over 1000 bins: turned on from bin to bin as by the definition, and each wave number as
    /// if it were alone.
    #[test]
    fn what_is_there_is_explained_whole_and_several_at_once_as_each_alone() {
        let (width, there) = (1e-3, 140.0);
        let sums: Vec<(f64, f64)> = (0..1000)
            .map(|bin| {
                let weight = 1.0 + f64::from(bin % 7);
                let (sine, cosine) = (there * width * f64::from(bin)).sin_cos();
                (weight * (3.0 * sine - 4.0 * cosine), weight)
            })
            .collect();
        let squares: f64 = sums.iter().map(|(sum, weight)| sum * sum / weight).sum();
        let waves = [100.0, there, 141.0];
        let strong = strengths(&sums, width, waves);
        assert!((strong[1] / squares - 1.0).abs() < 1e-9, "{strong:?}");
        assert!(
            strong[0] < 0.1 * squares && strong[2] < strong[1],
            "{strong:?}"
        );
        let alone = waves.map(|wave| strengths(&sums, width, [wave])[0]);
        assert_eq!(strong, alone);
    }
}
