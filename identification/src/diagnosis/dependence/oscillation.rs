//! A residual that swings with time, whatever the joint does: another machine, a structure that
//! rings, the mains.

use crate::design::{Design, PreparedModel};
use crate::numerics::waves::strengths;
use crate::signals::Signals;
use crate::validation::{Score, gain_within};

/// Sessions are cut into stretches of about this length \[s\], each with a phase of its own: no
/// oscillation stays in step for hours.
const STRETCH: f64 = 60.0;
/// Parts of a stretch of which each is predicted by the others.
const PARTS: usize = 10;
/// Periods in a stretch, at least: fewer are a slow variation.
const LEAST_PERIODS: f64 = 10.0;
/// Samples of a period, at least.
const LEAST_SAMPLES: f64 = 4.0;
/// Frequencies looked at in a period of the stretch.
const FINENESS: f64 = 2.0;
/// Frequencies looked at together.
const LANES: usize = 4;

/// What an oscillation explains.
pub(super) struct Oscillation {
    /// Its period \[s\].
    pub(super) period: f64,
    /// What it explains of rows left out.
    pub(super) score: Score,
    /// Frequencies tried.
    pub(super) tried: usize,
}

/// Samples of a stretch on a grid of time: the residual's sum and the number of rows, and
/// the first and the end of its rows.
struct Stretch {
    sums: Vec<(f64, f64)>,
    rows: std::ops::Range<usize>,
}

/// The strongest oscillation of the residual, each session with parameters of its own: of one
/// frequency in all stretches, of any size and phase in each. Each tenth of a stretch is
/// predicted by the others. `None` where sessions are too short for one, or where it explains
/// less than the share `least` of the rows that it is fitted to.
pub(super) fn find(prepared: &PreparedModel, design: &Design, least: f64) -> Option<Oscillation> {
    let stride = prepared.filters.stride.max(1);
    let period = prepared.sessions.first()?.period;
    let step = period * stride as f64;
    let residuals: Vec<Vec<f64>> = design.sessions.iter().map(|s| s.own_residual()).collect();
    let stretches: Vec<Vec<Stretch>> = prepared
        .sessions
        .iter()
        .zip(&residuals)
        .map(|(signals, residual)| cut(signals, residual, stride, (STRETCH / step) as usize))
        .collect();
    let longest = (stretches.iter().flatten())
        .map(|own| own.sums.len())
        .max()?;
    let length = longest as f64 * step;
    let lowest = LEAST_PERIODS / length;
    let highest = (1.0 / (LEAST_SAMPLES * step)).min(prepared.filters.cut_off(period));
    let tried = ((highest - lowest) * length * FINENESS).max(0.0) as usize;
    let frequency = |at: f64| lowest + at / (length * FINENESS);
    let explained = |at: [f64; LANES]| {
        let angles = at.map(|at| std::f64::consts::TAU * frequency(at));
        let each = stretches.iter().flatten();
        each.fold([0.0; LANES], |mut sum, own| {
            let own = strengths(&own.sums, step, angles);
            sum.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
            sum
        })
    };
    let best_of = |candidates: &mut dyn Iterator<Item = f64>| {
        let mut best = None;
        while let Some(first) = candidates.next() {
            let lanes = std::array::from_fn(|lane| match lane {
                0 => first,
                _ => candidates.next().unwrap_or(first),
            });
            for (at, gain) in lanes.into_iter().zip(explained(lanes)) {
                if best.is_none_or(|(most, _)| gain > most) {
                    best = Some((gain, at));
                }
            }
        }
        best
    };
    let (_, coarse) = best_of(&mut (0..tried).map(|at| at as f64))?;
    let mut finer = (-10..=10).map(|part| coarse + 0.1 * f64::from(part));
    let (explained, best) = best_of(&mut finer)?;
    let all: f64 = residuals.iter().flatten().map(|r| r * r).sum();
    if explained < least * all {
        return None;
    }
    let frequency = frequency(best);
    let columns: Vec<Vec<Vec<f64>>> = stretches
        .iter()
        .zip(&prepared.sessions)
        .zip(&residuals)
        .map(|((stretches, signals), residual)| {
            let all = stretches.iter();
            let column = all.flat_map(|own| predicted(signals, residual, own, frequency));
            vec![column.collect()]
        })
        .collect();
    Some(Oscillation {
        period: 1.0 / frequency,
        score: gain_within(design, &design.with(&columns)),
        tried,
    })
}

/// Cuts a session into stretches of about `most` steps of the grid.
fn cut(signals: &Signals, residual: &[f64], stride: usize, most: usize) -> Vec<Stretch> {
    let at = |row: usize| signals.rows[row] / stride;
    let Some(last) = signals.rows.len().checked_sub(1) else {
        return Vec::new();
    };
    let (first, end) = (at(0), at(last) + 1);
    let count = ((end - first) as f64 / most.max(1) as f64).round().max(1.0) as usize;
    let length = (end - first).div_ceil(count);
    let mut begin = 0;
    (0..count)
        .map(|number| {
            let from = first + number * length;
            let rows = begin
                ..signals
                    .rows
                    .partition_point(|own| own / stride < from + length);
            begin = rows.end;
            let mut sums = vec![(0.0, 0.0); length];
            for row in rows.clone() {
                if let Some((sum, weight)) = sums.get_mut(at(row) - from) {
                    *sum += residual[row];
                    *weight += 1.0;
                }
            }
            Stretch { sums, rows }
        })
        .collect()
}

/// The oscillation at the rows of a stretch, in each tenth of it as the others tell it.
fn predicted(signals: &Signals, residual: &[f64], of: &Stretch, frequency: f64) -> Vec<f64> {
    let wave = |row: usize| {
        let time = signals.time(signals.rows[row]);
        (std::f64::consts::TAU * frequency * time).sin_cos()
    };
    let part = |row: usize| (row - of.rows.start) * PARTS / of.rows.len();
    // Sums of ss, sc, cc, s r, c r over each part.
    let mut sums = [[0.0; 5]; PARTS];
    for row in of.rows.clone() {
        let (sine, cosine) = wave(row);
        let r = residual[row];
        let terms = [
            sine * sine,
            sine * cosine,
            cosine * cosine,
            sine * r,
            cosine * r,
        ];
        (sums[part(row)].iter_mut().zip(terms)).for_each(|(sum, term)| *sum += term);
    }
    let total: [f64; 5] = std::array::from_fn(|at| sums.iter().map(|own| own[at]).sum());
    let coefficients = sums.map(|own| {
        let [ss, sc, cc, sr, cr]: [f64; 5] = std::array::from_fn(|at| total[at] - own[at]);
        let determinant = ss * cc - sc * sc;
        match determinant > 1e-9 * ss * cc {
            true => [
                (cc * sr - sc * cr) / determinant,
                (ss * cr - sc * sr) / determinant,
            ],
            false => [0.0; 2],
        }
    });
    let at_row = |row: usize| {
        let (sine, cosine) = wave(row);
        let [of_sine, of_cosine] = coefficients[part(row)];
        of_sine * sine + of_cosine * cosine
    };
    of.rows.clone().map(at_row).collect()
}
