//! How much a candidate explains of data that it was not fitted to.
//!
//! Two views of the same Grams. **Within** sessions: each session keeps its own
//! parameters of the model, only the candidate's coefficients are shared and
//! come from the other sessions; variation of friction from day to day then
//! neither masks an effect nor imitates one. **Between** sessions: all parameters
//! are shared, as in a prediction for a new day; temperature and date show only
//! here.

pub mod left_out;
pub mod session_variation;

use nalgebra::DVector;

use crate::design::{BlockGrams, Design};
use crate::numerics::gram::Gram;
use crate::numerics::statistics::{f_tail, jackknife_covariance, jackknife_wald, mean_error};

/// What a candidate explains of rows left out.
#[derive(Clone, Debug, PartialEq)]
pub struct Score {
    /// Coefficients fitted to all rows, in the units of the effect.
    pub coefficients: Vec<f64>,
    /// Decrease of the squared error \[Nm²\], block by block (fold by fold between
    /// sessions).
    pub gains: Vec<f64>,
    /// Decrease of the mean square \[Nm²\].
    pub gain: f64,
    /// Standard error of `gain` \[Nm²\].
    pub gain_error: f64,
    /// Mean square without the candidate \[Nm²\], on the same rows left out.
    pub before: f64,
    /// Significance of the prediction of rows left out: slope of the measured over
    /// the predicted remainder, in standard errors by clusters \[1\]. Effects that
    /// are large in some sessions and absent in others are not penalised.
    pub certainty: f64,
    /// p-value of one candidate, not corrected for how many were tried.
    pub p_value: f64,
}

/// Products of prediction and measurement, cluster by cluster.
#[derive(Default)]
struct Slope {
    products: Vec<(f64, f64)>,
}

impl Slope {
    /// Adds a cluster left out: p·y and p·p of the prediction p.
    fn push(&mut self, with_measured: f64, with_itself: f64) {
        self.products.push((with_measured, with_itself.max(0.0)));
    }

    fn certainty(&self) -> f64 {
        let (top, bottom) = self
            .products
            .iter()
            .fold((0.0, 0.0), |(a, b), p| (a + p.0, b + p.1));
        if bottom <= 0.0 {
            return 0.0;
        }
        let slope: f64 = top / bottom;
        let count = self.products.len() as f64;
        let spread: f64 = self
            .products
            .iter()
            .map(|(py, pp)| (py - slope * pp).powi(2))
            .sum();
        top / (spread * count / (count - 1.0).max(1.0)).sqrt().max(1e-300)
    }
}

impl Score {
    fn new(
        coefficients: &DVector<f64>,
        gains: Vec<f64>,
        slope: &Slope,
        before: f64,
        rows: usize,
        p_value: f64,
    ) -> Self {
        let rows = rows.max(1) as f64;
        let (mean, error) = mean_error(&gains);
        let count = gains.len() as f64;
        Self {
            coefficients: coefficients.as_slice().to_vec(),
            gain: mean * count / rows,
            gain_error: error * count / rows,
            gains,
            before: before / rows,
            certainty: slope.certainty(),
            p_value,
        }
    }

    /// Share of the mean square that is explained \[1\].
    #[must_use]
    pub fn share(&self) -> f64 {
        self.gain / self.before.max(1e-300)
    }
}

/// Gram matrices of the extra columns, block by block, less what each session's own
/// parameters of the model explain of them; and their sum.
#[must_use]
pub fn reduced(design: &Design, grams: &BlockGrams) -> (BlockGrams, Gram) {
    let reduced: BlockGrams = grams
        .iter()
        .map(|session| {
            let Some(first) = session.first() else {
                return Vec::new();
            };
            let own = design.explain(&Gram::sum(session, first.columns()));
            session
                .iter()
                .map(|gram| gram.reduce(design.base, &own))
                .collect()
        })
        .collect();
    let columns = reduced.iter().flatten().next().map_or(0, Gram::columns);
    let total = Gram::sum(reduced.iter().flatten(), columns);
    (reduced, total)
}

/// Estimates with one block left out each: the deviation of a block from its
/// session is independent of the other blocks.
fn without_each(reduced: &BlockGrams, total: &Gram) -> Vec<DVector<f64>> {
    let blocks = reduced.iter().flatten();
    blocks.map(|gram| total.without(gram).solve()).collect()
}

/// p-value of the extra columns from number `first` on, beside those before
/// them: all of them shared, the model's own parameters each session's own.
#[must_use]
pub fn beside(design: &Design, grams: &BlockGrams, first: usize) -> f64 {
    let (reduced, total) = reduced(design, grams);
    let later = |all: DVector<f64>| {
        let first = first.min(all.len());
        all.rows(first, all.len() - first).into_owned()
    };
    let without: Vec<DVector<f64>> = without_each(&reduced, &total)
        .into_iter()
        .map(later)
        .collect();
    jackknife_wald(&later(total.solve()), &without)
}

/// Scores extra columns within sessions.
#[must_use]
pub fn within(design: &Design, grams: &BlockGrams) -> Score {
    let (reduced, total) = reduced(design, grams);
    let mut score = gain_of_folds(&design.folds, &reduced);
    score.p_value = jackknife_wald(&total.solve(), &without_each(&reduced, &total));
    score
}

/// The same without the test of the coefficients: p-value 1.
#[must_use]
pub fn gain_within(design: &Design, grams: &BlockGrams) -> Score {
    gain_of_folds(&design.folds, &reduced(design, grams).0)
}

/// The same of columns that are `reduced` already by what each session's own parameters
/// explain of them: block by block, y the last.
#[must_use]
pub fn gain_of_folds(folds: &[Vec<(usize, usize)>], reduced: &BlockGrams) -> Score {
    let columns = reduced.iter().flatten().next().map_or(0, Gram::columns);
    let total = Gram::sum(reduced.iter().flatten(), columns);
    let (mut gains, mut slope) = (Vec::new(), Slope::default());
    for fold in folds {
        let left_out: Vec<&Gram> = fold
            .iter()
            .filter_map(|(s, b)| reduced.get(*s).and_then(|r| r.get(*b)))
            .collect();
        let others = total.without(&Gram::sum(left_out.iter().copied(), columns));
        let coefficients = others.solve();
        for gram in left_out {
            let gain = gram.square() - gram.squared_error(&coefficients);
            let itself = quadratic(gram, &coefficients);
            slope.push(0.5 * (gain + itself), itself);
            gains.push(gain);
        }
    }
    let (before, rows) = (total.square(), total.rows);
    Score::new(&total.solve(), gains, &slope, before, rows, 1.0)
}

/// Scores extra columns between sessions: all parameters come from the other folds.
#[must_use]
pub fn between(design: &Design, grams: &BlockGrams) -> Score {
    let columns = grams.iter().flatten().next().map_or(0, Gram::columns);
    let total = Gram::sum(grams.iter().flatten(), columns);
    let extra = columns.saturating_sub(design.base);
    let tail = |c: &DVector<f64>| c.rows(columns - extra, extra).into_owned();
    let (mut gains, mut without, mut before) = (Vec::new(), Vec::new(), 0.0);
    let mut slope = Slope::default();
    for fold in &design.folds {
        let out = fold_gram(grams, fold, columns);
        let others = total.without(&out);
        let coefficients = others.solve();
        let base_only = select_base(&others, design.base).solve();
        let error_base = select_base(&out, design.base).squared_error(&base_only);
        let gain = error_base - out.squared_error(&coefficients);
        // What the full model predicts beyond the base model.
        let mut difference = coefficients.clone();
        difference
            .rows_mut(0, design.base)
            .zip_apply(&base_only, |d, b| *d -= b);
        let itself = quadratic(&out, &difference);
        slope.push(0.5 * (gain + itself), itself);
        gains.push(gain);
        before += error_base;
        without.push(tail(&coefficients));
    }
    let estimate = tail(&total.solve());
    let p_value = jackknife_wald(&estimate, &without);
    Score::new(&estimate, gains, &slope, before, total.rows, p_value)
}

/// p-value of the difference between the coefficient of the (single) extra column
/// within and between sessions; 1 where the column hardly varies within a session.
#[must_use]
pub fn agreement(design: &Design, grams: &BlockGrams) -> f64 {
    let columns = grams.iter().flatten().next().map_or(0, Gram::columns);
    if columns != design.base + 1 {
        return 1.0;
    }
    let total = Gram::sum(grams.iter().flatten(), columns);
    let last = |c: DVector<f64>| c.rows(columns - 1, 1).into_owned();
    let without: Vec<DVector<f64>> = design
        .folds
        .iter()
        .map(|fold| last(total.without(&fold_gram(grams, fold, columns)).solve()))
        .collect();
    let between = last(total.solve());
    let reduced: Vec<Gram> = grams
        .iter()
        .map(|session| {
            let own = Gram::sum(session, columns);
            // Differences between sessions must not enter here.
            own.reduce(design.base, &own.explain_freely(design.base))
        })
        .collect();
    let inside = Gram::sum(&reduced, 1);
    let within = inside.solve();
    let inside_without: Vec<DVector<f64>> = reduced
        .iter()
        .map(|session| inside.without(session).solve())
        .collect();
    let variance = jackknife_covariance(&between, &without)[(0, 0)]
        + jackknife_covariance(&within, &inside_without)[(0, 0)];
    if variance > 0.0 && variance.is_finite() {
        let sessions = inside_without.len() as f64;
        f_tail(
            (within[0] - between[0]).powi(2) / variance,
            1.0,
            sessions - 1.0,
        )
    } else {
        1.0
    }
}

/// Σ (X c)².
fn quadratic(gram: &Gram, coefficients: &DVector<f64>) -> f64 {
    let n = gram.columns();
    (coefficients.transpose() * gram.products.view((0, 0), (n, n)) * coefficients)[(0, 0)]
}

/// Gram of the rows of one fold.
#[must_use]
pub fn fold_gram(grams: &BlockGrams, fold: &[(usize, usize)], columns: usize) -> Gram {
    Gram::sum(
        fold.iter()
            .filter_map(|(s, b)| grams.get(*s).and_then(|g| g.get(*b))),
        columns,
    )
}

/// The Gram of the first `base` columns and y.
#[must_use]
pub fn select_base(gram: &Gram, base: usize) -> Gram {
    let last = gram.columns();
    let keep: Vec<usize> = (0..base).chain([last]).collect();
    Gram {
        rows: gram.rows,
        products: nalgebra::DMatrix::from_fn(base + 1, base + 1, |i, j| {
            gram.products[(keep[i], keep[j])]
        }),
    }
}
