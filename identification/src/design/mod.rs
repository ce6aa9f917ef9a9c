//! The regression: rows, columns, blocks of time, and their Gram matrices.

pub mod columns;

use nalgebra::{DMatrix, DVector};

use crate::effects::EffectHandle;
use crate::gram::Gram;
use crate::setup::Setup;
use crate::signals::Signals;
use crate::statistics::jackknife_covariance;

/// Blocks of time in all, at least; a session is one or more of them.
const MIN_BLOCKS: usize = 12;

/// Rows of one session.
#[derive(Clone, Debug)]
pub struct SessionDesign {
    /// y = τ_m − τ − J q̈, filtered \[Nm\].
    pub measured: Vec<f64>,
    /// Columns of the model's effects, filtered.
    pub base: Vec<Vec<f64>>,
    /// First row and the row past the last, of each block of time.
    pub blocks: Vec<(usize, usize)>,
    /// Gram of each block: base columns and y.
    pub grams: Vec<Gram>,
}

/// How far a session's own parameters may lie from those of all sessions, as a
/// share of these …
const SCATTER: f64 = 1.0;
/// … and in their standard errors by sessions left out.
const SCATTER_ERRORS: f64 = 2.0;

/// Rows of all sessions that are fitted.
#[derive(Clone, Debug)]
pub struct Design {
    /// One for each session.
    pub sessions: Vec<SessionDesign>,
    /// Number of base columns.
    pub base: usize,
    /// Which (session, block) are left out together.
    pub folds: Vec<Vec<(usize, usize)>>,
    /// Parameters of all sessions together.
    pub shared: DVector<f64>,
    /// Their covariance, by folds left out.
    pub covariance: DMatrix<f64>,
    /// What holds a session's own parameters to them: mean square of what is left
    /// \[Nm²\] over the square of how far they may lie apart. A session that does
    /// not excite a parameter (friction by load, free of load) has none of its own.
    hold: DVector<f64>,
}

/// Grams of base, candidate columns and y, by session and block.
pub type BlockGrams = Vec<Vec<Gram>>;

impl Design {
    /// Builds the rows of the model as it stands in `setup`.
    #[must_use]
    pub fn new(setup: &Setup) -> Self {
        let per_session = MIN_BLOCKS.div_ceil(setup.sessions.len().max(1));
        let sessions: Vec<SessionDesign> = setup
            .sessions
            .iter()
            .map(|signals| SessionDesign::new(setup, signals, &signals.rows, per_session))
            .collect();
        let base = setup.terms.iter().map(|t| t.effect.columns()).sum();
        let whole = sessions.iter().filter(|s| !s.measured.is_empty()).count() >= 3;
        let mut folds = Vec::new();
        for (s, session) in sessions.iter().enumerate() {
            let blocks: Vec<(usize, usize)> = (0..session.blocks.len()).map(|b| (s, b)).collect();
            if blocks.is_empty() {
                continue;
            }
            if whole {
                folds.push(blocks);
            } else {
                folds.extend(blocks.into_iter().map(|b| vec![b]));
            }
        }
        let mut design = Self {
            sessions,
            base,
            folds,
            shared: DVector::zeros(base),
            covariance: DMatrix::zeros(base, base),
            hold: DVector::zeros(base),
        };
        design.fit();
        design
    }

    /// Finds the parameters of all sessions together, and what holds a session's
    /// own to them.
    fn fit(&mut self) {
        let total = self.total();
        let shared = total.solve();
        let without: Vec<DVector<f64>> = self
            .folds
            .iter()
            .map(|fold| {
                let block = |(s, b): &(usize, usize)| self.sessions.get(*s)?.grams.get(*b);
                let out = Gram::sum(fold.iter().filter_map(block), self.base);
                total.without(&out).solve()
            })
            .collect();
        let covariance = jackknife_covariance(&shared, &without);
        let left = total.squared_error(&shared) / total.rows.max(1) as f64;
        self.hold = DVector::from_fn(self.base, |k, _| {
            let error = covariance[(k, k)].max(0.0).sqrt();
            let apart = SCATTER * shared[k].abs() + SCATTER_ERRORS * error;
            if apart > 0.0 {
                left / (apart * apart)
            } else {
                0.0
            }
        });
        (self.shared, self.covariance) = (shared, covariance);
    }

    /// Coefficients by which a session's own parameters, which lie around those
    /// of all sessions, explain the extra columns and y of its Gram `own`.
    #[must_use]
    pub fn explain(&self, own: &Gram) -> DMatrix<f64> {
        own.explain(&self.shared, &self.hold)
    }

    /// Gram of all rows.
    #[must_use]
    pub fn total(&self) -> Gram {
        Gram::sum(self.sessions.iter().flat_map(|s| &s.grams), self.base)
    }

    /// The model's own Grams.
    #[must_use]
    pub fn own(&self) -> BlockGrams {
        self.sessions.iter().map(|s| s.grams.clone()).collect()
    }

    /// Columns of another effect on every session.
    #[must_use]
    pub fn extra_columns(
        &self,
        setup: &Setup,
        effect: &EffectHandle,
        shape: &[f64],
    ) -> Vec<Vec<Vec<f64>>> {
        setup
            .sessions
            .iter()
            .map(|signals| {
                let inertia = setup.facts.inertia.unwrap_or(0.0);
                columns::filtered(
                    signals,
                    &setup.filters,
                    inertia,
                    effect,
                    shape,
                    &signals.rows,
                )
            })
            .collect()
    }

    /// Grams with another effect's columns, or any others, put in.
    #[must_use]
    pub fn with(&self, extra: &[Vec<Vec<f64>>]) -> BlockGrams {
        self.sessions
            .iter()
            .zip(extra)
            .map(|(session, columns)| {
                let base = session.base_and_measured();
                let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
                session
                    .blocks
                    .iter()
                    .zip(&session.grams)
                    .map(|((from, to), gram)| gram.with(&base, &columns, *from, *to))
                    .collect()
            })
            .collect()
    }
}

impl SessionDesign {
    /// Rows `rows` of one session in `count` blocks of time.
    #[must_use]
    pub fn new(setup: &Setup, signals: &Signals, rows: &[usize], count: usize) -> Self {
        let inertia = setup.facts.inertia.unwrap_or(0.0);
        let mut measured = columns::measured(signals, &setup.filters, inertia, rows);
        let mut base = Vec::new();
        for term in &setup.terms {
            let own = columns::of_term(signals, &setup.filters, inertia, term, rows);
            // What has been taken out of the channels is fitted again around where
            // it was: the coefficient is all of it.
            for (column, coefficient) in own.iter().zip(&term.undone) {
                let taken = measured.iter_mut().zip(column);
                taken.for_each(|(measured, value)| *measured += coefficient * value);
            }
            base.extend(own);
        }
        let blocks = blocks(rows.len(), count);
        let views: Vec<&[f64]> = base.iter().map(Vec::as_slice).collect();
        let grams = blocks
            .iter()
            .map(|(from, to)| Gram::of(&views, &measured, *from, *to))
            .collect();
        Self {
            measured,
            base,
            blocks,
            grams,
        }
    }

    /// Base columns, then y.
    #[must_use]
    pub fn base_and_measured(&self) -> Vec<&[f64]> {
        self.base
            .iter()
            .map(Vec::as_slice)
            .chain([self.measured.as_slice()])
            .collect()
    }
}

/// Cuts `rows` rows into `count` blocks of equal length, fewer if they are few.
fn blocks(rows: usize, count: usize) -> Vec<(usize, usize)> {
    let count = count.min(rows / 20).max(usize::from(rows > 0));
    (0..count)
        .map(|b| (b * rows / count, (b + 1) * rows / count))
        .collect()
}
