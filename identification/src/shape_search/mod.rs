//! Search for the shape of an effect: a grid, then golden sections.
//!
//! Of very many rows, a part (`part`) tells first whether an effect may be anything, and about
//! where its best shape is. What may be something is then compared and refined on all rows, by
//! the steps that lead there without the part.

mod golden_section;
mod part;
pub mod periodicity;
#[cfg(test)]
mod tests;

use crate::design::{BlockGrams, Design, PreparedModel};
use crate::effects::{EffectHandle, combinations};
use crate::numerics::gram::Gram;
use crate::validation::{between, gain_within};

pub(crate) use golden_section::golden_section;
use part::Part;

/// Rounds over all parameters of a shape, at most …
const MAX_ROUNDS: usize = 6;
/// … and no more after one that leaves a larger share of the error than this.
const MAX_REMAINING_SHARE: f64 = 0.995;
/// Grid points for each searched parameter that has bounds but no grid.
const GRID_POINTS: usize = 12;
/// Shapes of a grid, the best on a part of the rows, that are compared on all of them.
const COMPARED: usize = 3;
/// Share of what the best explains there that the others do, at least.
const MIN_SHARE_OF_BEST: f64 = 0.8;

/// What an effect at one shape leaves of the squared error \[Nm²\], each session with its own
/// parameters of the model.
#[derive(Clone, Copy, Debug)]
struct Left {
    error: f64,
    /// Error without the effect.
    before: f64,
    plausible: bool,
}

impl Left {
    /// The error; infinite where the coefficients are not plausible.
    fn error_if_plausible(self) -> f64 {
        match self.plausible {
            true => self.error,
            false => f64::INFINITY,
        }
    }

    /// What is explained.
    fn gain(self) -> f64 {
        self.before - self.error
    }

    /// Share of the error that is explained.
    fn share(self) -> f64 {
        self.gain() / self.before.max(1e-300)
    }
}

/// A model and rows.
#[derive(Clone, Copy)]
struct Rows<'a> {
    prepared: &'a PreparedModel,
    design: &'a Design,
}

impl Rows<'_> {
    fn grams(&self, effect: &EffectHandle, shape: &[f64]) -> BlockGrams {
        let Rows { prepared, design } = self;
        design.with(&design.extra_columns(prepared, effect, shape))
    }

    fn left(&self, effect: &EffectHandle, shape: &[f64]) -> Left {
        let Rows { design, .. } = self;
        let grams = self.grams(effect, shape);
        let reduced = match effect.row().is_between_sessions() {
            true => {
                let columns = grams
                    .iter()
                    .flatten()
                    .next()
                    .map_or(design.base, Gram::columns);
                let total = Gram::sum(grams.iter().flatten(), columns);
                total.reduce(design.base, &total.explain_freely(design.base))
            }
            false => design.remainder(&grams),
        };
        let coefficients = reduced.solve();
        Left {
            error: reduced.squared_error(&coefficients),
            before: reduced.square(),
            plausible: effect.plausible(shape, coefficients.as_slice()),
        }
    }

    /// Share of the mean square that is explained of rows left out.
    fn share(&self, effect: &EffectHandle, shape: &[f64]) -> f64 {
        let grams = self.grams(effect, shape);
        let score = match effect.row().is_between_sessions() {
            true => between(self.design, &grams),
            false => gain_within(self.design, &grams),
        };
        score.share()
    }

    fn error_of(&self, effect: &EffectHandle, shape: &[f64]) -> f64 {
        self.left(effect, shape).error_if_plausible()
    }
}

/// A shape and the error that it leaves.
type Found = (f64, Vec<f64>);

/// The least error, and the first of the shapes that leave it.
fn least(found: impl Iterator<Item = Found>) -> Option<Found> {
    found.min_by(|a, b| a.0.total_cmp(&b.0))
}

/// Searches for shapes of effects beside one model.
pub struct Search<'a> {
    all: Rows<'a>,
    /// A part of very many rows.
    part: Option<Part>,
}

impl<'a> Search<'a> {
    /// In the model `prepared`, on the rows of its `design`.
    #[must_use]
    pub fn new(prepared: &'a PreparedModel, design: &'a Design) -> Self {
        Self {
            all: Rows { prepared, design },
            part: Part::new(prepared, design),
        }
    }

    /// The best of `shapes`, refined; `None` if there is none to try.
    #[must_use]
    pub fn best(&self, effect: &EffectHandle, shapes: Vec<Vec<f64>>) -> Option<Vec<f64>> {
        let (error, shape) = match &self.part {
            None => self.compare(effect, shapes)?,
            Some(part) => {
                let rows = part.rows_for(effect, shapes.first()?);
                self.compare_tried(effect, &try_all(rows, effect, shapes))?
            }
        };
        Some(self.refine(effect, shape, error))
    }

    /// The same of an effect that the model may lack. One that explains less than `notable` of
    /// the error on a part of the rows, and with the best shapes there on all of them, is
    /// searched no further. A shape is refined only where a plausible one is known.
    #[must_use]
    pub fn best_if_any(
        &self,
        effect: &EffectHandle,
        shapes: Vec<Vec<f64>>,
        notable: f64,
    ) -> Option<Vec<f64>> {
        if shapes.len() == 1 && effect.bounds(&self.all.prepared.facts).is_empty() {
            return shapes.into_iter().next();
        }
        let (error, shape) = match &self.part {
            None => self.compare(effect, shapes)?,
            Some(part) => {
                let rows = part.rows_for(effect, shapes.first()?);
                let tried = try_all(rows, effect, shapes);
                let rough = nothing_on(rows, effect, &tried, notable);
                let found = self.compare_tried(effect, &tried)?;
                if let Some(shape) = rough {
                    let left = self.all.left(effect, &shape);
                    let least = found.0.min(left.error_if_plausible());
                    if least > (1.0 - notable) * left.before {
                        return match left.plausible {
                            true => Some(shape),
                            false => Some(found.1),
                        };
                    }
                }
                found
            }
        };
        match error.is_finite() {
            true => Some(self.refine(effect, shape, error)),
            false => Some(shape),
        }
    }

    /// The best of `shapes` on all rows.
    fn compare(
        &self,
        effect: &EffectHandle,
        shapes: impl IntoIterator<Item = Vec<f64>>,
    ) -> Option<Found> {
        least((shapes.into_iter()).map(|shape| (self.all.error_of(effect, &shape), shape)))
    }

    /// The same of those of the best few of shapes tried on a part of them that explain nearly as
    /// much as the best there, plausible ones alone; the first of all where none is plausible.
    fn compare_tried(&self, effect: &EffectHandle, tried: &[(Left, Vec<f64>)]) -> Option<Found> {
        let mut plausible: Vec<&(Left, Vec<f64>)> =
            tried.iter().filter(|(left, _)| left.plausible).collect();
        plausible.sort_by(|(a, _), (b, _)| a.error.total_cmp(&b.error));
        let most = plausible.first().map_or(0.0, |(left, _)| left.gain());
        let best = plausible.iter().take(COMPARED);
        let best = best.take_while(|(left, _)| left.gain() >= MIN_SHARE_OF_BEST * most);
        let found = self.compare(effect, best.map(|(_, shape)| shape.clone()));
        match found.filter(|(error, _)| error.is_finite()) {
            Some(found) => Some(found),
            None => Some((f64::INFINITY, tried.first()?.1.clone())),
        }
    }

    /// Refines a shape by golden sections, one parameter after the other, each between
    /// the neighbouring grid points of its value; several parameters repeatedly, while
    /// the error falls, since they may be correlated.
    fn refine(&self, effect: &EffectHandle, start: Vec<f64>, error: f64) -> Vec<f64> {
        let of_all = |shape: &[f64]| self.all.error_of(effect, shape);
        let found = refine(
            &self.all,
            effect,
            (error, start),
            |shape, at, range, error| match &self.part {
                None => golden_section(shape, at, range, error, of_all),
                Some(part) => {
                    let rows = part.rows_for(effect, shape);
                    let of_part = |shape: &[f64]| rows.error_of(effect, shape);
                    golden_section::in_two_stages(shape, at, range, error, of_part, of_all)
                }
            },
        );
        found.1
    }
}

/// What each of `shapes` leaves.
fn try_all(
    rows: Rows<'_>,
    effect: &EffectHandle,
    shapes: impl IntoIterator<Item = Vec<f64>>,
) -> Vec<(Left, Vec<f64>)> {
    let each = shapes.into_iter();
    each.map(|shape| (rows.left(effect, &shape), shape))
        .collect()
}

/// The best plausible shape of those tried on `rows`, refined there, where it explains less than
/// a `notable` share of the error.
fn nothing_on(
    rows: Rows<'_>,
    effect: &EffectHandle,
    tried: &[(Left, Vec<f64>)],
    notable: f64,
) -> Option<Vec<f64>> {
    let is_notable = |shape: &[f64]| {
        // Rows that are fitted tell more than rows left out.
        let fitted = rows.left(effect, shape).share();
        fitted >= notable && rows.share(effect, shape) >= notable
    };
    let errors = tried.iter();
    let errors = errors.map(|(left, shape)| (left.error_if_plausible(), shape.clone()));
    let (error, shape) = least(errors)?;
    if error.is_infinite() {
        return Some(shape);
    }
    if is_notable(&shape) {
        return None;
    }
    let of_rows = |shape: &[f64]| rows.error_of(effect, shape);
    let (_, shape) = refine(&rows, effect, (error, shape), |shape, at, range, error| {
        golden_section(shape, at, range, error, of_rows)
    });
    (!is_notable(&shape)).then_some(shape)
}

/// Refines a shape and its error by searches along one parameter at a time: `along` puts the
/// best value within a range at a place of the shape, which leaves an error, and returns the
/// error that is left then.
fn refine(
    rows: &Rows<'_>,
    effect: &EffectHandle,
    (mut error, mut shape): Found,
    mut along: impl FnMut(&mut [f64], usize, [f64; 2], f64) -> f64,
) -> Found {
    let bounds = effect.bounds(&rows.prepared.facts);
    if bounds.len() != shape.len() {
        return (error, shape);
    }
    let grid = grid(rows.prepared, effect);
    let searched = bounds.iter().filter(|[low, high]| high > low).count();
    let rounds = if searched > 1 { MAX_ROUNDS } else { 1 };
    for _ in 0..rounds {
        let before = error;
        let spacing = spacing(&grid, &shape);
        for at in 0..shape.len() {
            let low = bounds[at][0].max(shape[at] - spacing[at]);
            let high = bounds[at][1].min(shape[at] + spacing[at]);
            if high > low {
                error = along(&mut shape, at, [low, high], error);
            }
        }
        if error > MAX_REMAINING_SHARE * before {
            break;
        }
    }
    (error, shape)
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
    let axis = |[low, high]: &[f64; 2]| {
        (0..count)
            .map(|i| {
                let share = i as f64 / (count - 1) as f64;
                // Positive bounds far apart are scanned by ratio.
                if *low > 0.0 && high / low > 8.0 {
                    low * (high / low).powf(share)
                } else {
                    low + (high - low) * share
                }
            })
            .collect()
    };
    combinations(&bounds.iter().map(axis).collect::<Vec<_>>())
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

/// Shapes to try: those of the grid, and of a periodic effect the strongest wave numbers.
#[must_use]
pub fn shapes(prepared: &PreparedModel, design: &Design, effect: &EffectHandle) -> Vec<Vec<f64>> {
    let mut shapes = grid(prepared, effect);
    if effect.row().is_periodic {
        let peaks = periodicity::peaks(prepared, design, effect, 3);
        shapes.extend(peaks.into_iter().map(|k| vec![k]));
    }
    shapes
}

/// The best shape on grid and golden sections; `None` if the effect has no shape
/// to try.
#[must_use]
pub fn search(
    prepared: &PreparedModel,
    design: &Design,
    effect: &EffectHandle,
) -> Option<Vec<f64>> {
    let shapes = shapes(prepared, design, effect);
    Search::new(prepared, design).best(effect, shapes)
}

/// Refines a shape that is known about.
#[must_use]
pub fn polish(
    prepared: &PreparedModel,
    design: &Design,
    effect: &EffectHandle,
    start: &[f64],
) -> Vec<f64> {
    let search = Search::new(prepared, design);
    let error = search.all.error_of(effect, start);
    search.refine(effect, start.to_vec(), error)
}
