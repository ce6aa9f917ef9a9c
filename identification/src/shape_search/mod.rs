//! Search for the shape of an effect: a grid, then golden sections.

pub mod periodicity;

use crate::design::{Design, PreparedModel};
use crate::effects::EffectHandle;
use crate::numerics::gram::Gram;

/// Rounds over all parameters of a shape, at most …
const MAX_ROUNDS: usize = 6;
/// … and no more after one that leaves a larger share of the error than this.
const MAX_REMAINING_SHARE: f64 = 0.995;
/// Grid points for each searched parameter that has bounds but no grid.
const GRID_POINTS: usize = 12;

/// Squared error \[Nm²\] that a shape leaves, each session with its own parameters of
/// the model; infinite where the coefficients are not plausible.
#[must_use]
pub fn error_of(
    prepared: &PreparedModel,
    design: &Design,
    effect: &EffectHandle,
    shape: &[f64],
) -> f64 {
    let grams = design.with(&design.extra_columns(prepared, effect, shape));
    let reduced = if effect.row().is_between_sessions() {
        let flat: Vec<Gram> = grams.into_iter().flatten().collect();
        let Some(first) = flat.first() else {
            return f64::INFINITY;
        };
        let total = Gram::sum(&flat, first.columns());
        total.reduce(design.base, &total.explain_freely(design.base))
    } else {
        design.remainder(&grams)
    };
    let coefficients = reduced.solve();
    let error = reduced.squared_error(&coefficients);
    if effect.plausible(shape, coefficients.as_slice()) {
        error
    } else {
        f64::INFINITY
    }
}

/// Shapes to try: the effect's own grid, or one over its bounds.
#[must_use]
pub fn grid(prepared: &PreparedModel, effect: &EffectHandle) -> Vec<Vec<f64>> {
    let shapes = effect.shapes(&prepared.facts);
    let bounds = effect.bounds(&prepared.facts);
    if shapes.len() > 1 || bounds.is_empty() {
        return shapes;
    }
    // Several parameters share a limited number of points.
    let count = match bounds.len() {
        1 => GRID_POINTS,
        2 => 8,
        _ => 4,
    };
    let mut grid = vec![Vec::new()];
    for [low, high] in &bounds {
        let values: Vec<f64> = (0..count)
            .map(|i| {
                let share = i as f64 / (count - 1) as f64;
                // Positive bounds far apart are scanned by ratio.
                if *low > 0.0 && high / low > 8.0 {
                    low * (high / low).powf(share)
                } else {
                    low + (high - low) * share
                }
            })
            .collect();
        grid = grid
            .iter()
            .flat_map(|shape| values.iter().map(|v| [shape.clone(), vec![*v]].concat()))
            .collect();
    }
    grid
}

/// Refines a shape by golden sections, one parameter after the other, each between
/// the neighbouring grid points of its value; several parameters repeatedly, while
/// the error falls, since they may be correlated.
#[must_use]
pub fn polish(
    prepared: &PreparedModel,
    design: &Design,
    effect: &EffectHandle,
    start: &[f64],
) -> Vec<f64> {
    let bounds = effect.bounds(&prepared.facts);
    let mut shape = start.to_vec();
    if bounds.len() != shape.len() {
        return shape;
    }
    let grid = grid(prepared, effect);
    let mut error = error_of(prepared, design, effect, &shape);
    let searched = bounds.iter().filter(|[low, high]| high > low).count();
    let rounds = if searched > 1 { MAX_ROUNDS } else { 1 };
    for _ in 0..rounds {
        let before = error;
        let spacing = spacing(&grid, &shape);
        for at in 0..shape.len() {
            let low = bounds[at][0].max(shape[at] - spacing[at]);
            let high = bounds[at][1].min(shape[at] + spacing[at]);
            if high > low {
                error = golden_section(&mut shape, at, [low, high], error, |shape| {
                    error_of(prepared, design, effect, shape)
                });
            }
        }
        if error > MAX_REMAINING_SHARE * before {
            break;
        }
    }
    shape
}

/// Puts the best value between `low` and `high` at place `at` of `shape`, which
/// leaves `error` as it is; the error that is left then.
pub(crate) fn golden_section(
    shape: &mut [f64],
    at: usize,
    [low, high]: [f64; 2],
    error: f64,
    mut error_of: impl FnMut(&[f64]) -> f64,
) -> f64 {
    let (mut best, mut best_error) = (shape[at], error);
    let mut try_value = |value: f64| {
        shape[at] = value;
        let error = error_of(shape);
        if error < best_error {
            (best, best_error) = (value, error);
        }
        error
    };
    let ratio = 0.618_034;
    let (mut a, mut b) = (low, high);
    let (mut c, mut d) = (b - ratio * (b - a), a + ratio * (b - a));
    let (mut at_c, mut at_d) = (try_value(c), try_value(d));
    for _ in 0..9 {
        if at_c < at_d {
            (b, d, at_d) = (d, c, at_c);
            c = b - ratio * (b - a);
            at_c = try_value(c);
        } else {
            (a, c, at_c) = (c, d, at_d);
            d = a + ratio * (b - a);
            at_d = try_value(d);
        }
    }
    shape[at] = best;
    best_error
}

/// Distance to the farther of the neighbouring grid values, of each parameter.
fn spacing(grid: &[Vec<f64>], shape: &[f64]) -> Vec<f64> {
    (0..shape.len())
        .map(|at| {
            let mut above = f64::INFINITY;
            let mut below = f64::INFINITY;
            for other in grid {
                let gap = other.get(at).copied().unwrap_or(shape[at]) - shape[at];
                if gap > 1e-9 * shape[at].abs() {
                    above = above.min(gap);
                } else if gap < -1e-9 * shape[at].abs() {
                    below = below.min(-gap);
                }
            }
            match (above.is_finite(), below.is_finite()) {
                (true, true) => above.max(below),
                (true, false) => above,
                (false, true) => below,
                (false, false) => 0.3 * shape[at].abs(),
            }
        })
        .collect()
}

/// The best shape on grid and golden sections; `None` if the effect has no shape
/// to try.
#[must_use]
pub fn search(
    prepared: &PreparedModel,
    design: &Design,
    effect: &EffectHandle,
) -> Option<Vec<f64>> {
    let mut candidates = grid(prepared, effect);
    if effect.row().is_periodic {
        candidates.extend(
            periodicity::peaks(prepared, design, effect, 3)
                .into_iter()
                .map(|k| vec![k]),
        );
    }
    let best = candidates
        .into_iter()
        .map(|shape| (error_of(prepared, design, effect, &shape), shape))
        .min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(polish(prepared, design, effect, &best.1))
}
