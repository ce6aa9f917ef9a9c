//! The regression: rows, columns, blocks of time, and their Gram matrices.

pub mod columns;
mod prepared_model;

use nalgebra::{DMatrix, DVector};

use crate::effects::{EffectHandle, Part, with_columns};
use crate::numerics::gram::Gram;
use crate::numerics::statistics::jackknife_covariance;
use crate::signals::Signals;

pub use prepared_model::PreparedModel;

/// Blocks of time in all, at least; a session is one or more of them.
const MIN_BLOCKS: usize = 12;
/// Rows of a block, at least …
const ROWS_OF_BLOCK: usize = 20;
/// … but for so many blocks of a session, however short.
const FEWEST_BLOCKS: usize = 3;

/// Sessions from which standard errors are by sessions left out: two tell nothing
/// of their variation.
const MIN_SESSIONS_FOR_ERRORS: usize = 3;
/// Smallest share of the rows in the shorter of two sessions that is left out as
/// a whole, and predicts the other.
const MIN_SHARE_OF_TWO: f64 = 0.2;

/// Rows of one session: measured side and columns of the model.
#[derive(Clone, Debug)]
pub struct SessionDesign {
    /// y = τ_m − τ − J q̈, filtered \[Nm\].
    pub measured: Vec<f64>,
    /// Columns of the model's effects, filtered, in the order of its terms.
    pub base: Vec<Vec<f64>>,
    /// Whether a row counts for errors.
    pub judged: Vec<bool>,
    /// First row and the row past the last, of each block of time.
    pub blocks: Vec<(usize, usize)>,
    /// Gram of each block: base columns and y.
    pub grams: Vec<Gram>,
}

/// Expected deviation of a session's own parameters from those of all sessions, as
/// a share of these …
const DEVIATION_SHARE: f64 = 1.0;
/// … plus a multiple of their standard errors by sessions left out.
const DEVIATION_IN_STD_ERRORS: f64 = 2.0;

/// Rows of all sessions that are fitted.
#[derive(Clone, Debug)]
pub struct Design {
    /// One for each session.
    pub sessions: Vec<SessionDesign>,
    /// Number of base columns.
    pub base: usize,
    /// Which (session, block) are left out together for standard errors and tests:
    /// whole sessions where there are three or more, else single blocks.
    pub folds: Vec<Vec<(usize, usize)>>,
    /// Which are left out together for the error that is reported: whole sessions
    /// where there are two or more, else single blocks.
    pub left_out: Vec<Vec<(usize, usize)>>,
    /// Parameters of all sessions together.
    pub shared: DVector<f64>,
    /// Their covariance, by folds left out.
    pub covariance: DMatrix<f64>,
    /// Weights that draw a session's own parameters to them: mean square of the
    /// residual \[Nm²\] over the square of the expected deviation. A session that
    /// does not excite a parameter (friction by load, free of load) then keeps the
    /// shared one.
    hold: DVector<f64>,
}

/// Gram matrices of base columns, candidate columns and y, by session and block.
pub type BlockGrams = Vec<Vec<Gram>>;

impl Design {
    /// Computes rows and Gram matrices of the model on the sessions that are fitted.
    #[must_use]
    pub fn new(prepared: &PreparedModel) -> Self {
        let per_session = Self::blocks_per_session(prepared.sessions.len());
        let sessions: Vec<SessionDesign> = prepared
            .sessions
            .iter()
            .map(|signals| SessionDesign::new(prepared, signals, &signals.rows, per_session))
            .collect();
        let base = prepared.terms.iter().map(|t| t.effect.columns()).sum();
        let blocks = |(s, session): (usize, &SessionDesign)| -> Vec<(usize, usize)> {
            (0..session.blocks.len()).map(|b| (s, b)).collect()
        };
        let mut by_session: Vec<_> = sessions.iter().enumerate().map(blocks).collect();
        by_session.retain(|session| !session.is_empty());
        let by_block = || by_session.iter().flatten().map(|block| vec![*block]);
        let folds = match by_session.len() >= MIN_SESSIONS_FOR_ERRORS {
            true => by_session.clone(),
            false => by_block().collect(),
        };
        let left_out = match one_predicts_the_other(&sessions) {
            true => by_session,
            false => by_block().collect(),
        };
        let mut design = Self {
            sessions,
            base,
            folds,
            left_out,
            shared: DVector::zeros(base),
            covariance: DMatrix::zeros(base, base),
            hold: DVector::zeros(base),
        };
        design.fit();
        design
    }

    /// The same regression on a part of its rows: of each session those with these numbers, in
    /// order. Parameters are those of all rows.
    #[must_use]
    pub fn on_rows(&self, numbers: &[Vec<usize>]) -> Self {
        let sessions = self.sessions.iter().zip(numbers);
        let sessions: Vec<SessionDesign> = sessions.map(|(own, rows)| own.on_rows(rows)).collect();
        let count = |sessions: &[SessionDesign]| -> usize {
            sessions.iter().map(|own| own.measured.len()).sum()
        };
        // What the data say weighs less against what draws a session's parameters.
        let share = count(&sessions) as f64 / count(&self.sessions).max(1) as f64;
        Self {
            sessions,
            hold: &self.hold * share,
            ..self.clone_without_rows()
        }
    }

    /// Everything but the rows.
    fn clone_without_rows(&self) -> Self {
        Self {
            sessions: Vec::new(),
            base: self.base,
            folds: self.folds.clone(),
            left_out: self.left_out.clone(),
            shared: self.shared.clone(),
            covariance: self.covariance.clone(),
            hold: self.hold.clone(),
        }
    }

    /// Number of blocks of time that each of so many sessions is cut into.
    #[must_use]
    pub const fn blocks_per_session(sessions: usize) -> usize {
        match sessions {
            0 => MIN_BLOCKS,
            sessions => MIN_BLOCKS.div_ceil(sessions),
        }
    }

    /// Whether the error that is reported is that of whole sessions left out.
    #[must_use]
    pub fn leaves_sessions_out(&self) -> bool {
        one_predicts_the_other(&self.sessions)
    }

    /// Whether standard errors are by blocks of time, of too few sessions.
    #[must_use]
    pub fn errors_are_by_blocks(&self) -> bool {
        let with_rows = self.sessions.iter().filter(|own| !own.blocks.is_empty());
        with_rows.count() < MIN_SESSIONS_FOR_ERRORS
    }

    /// Fits the parameters of all sessions together, and the weights that draw a
    /// session's own to them.
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
            let apart = DEVIATION_SHARE * shared[k].abs() + DEVIATION_IN_STD_ERRORS * error;
            if apart > 0.0 {
                left / (apart * apart)
            } else {
                0.0
            }
        });
        (self.shared, self.covariance) = (shared, covariance);
    }

    /// Mean square of what the model leaves of sessions that are each fitted by themselves \[Nm²\].
    #[must_use]
    pub fn own_mean_square(&self) -> f64 {
        let totals = self.sessions.iter();
        let totals = totals.map(|own| Gram::sum(&own.grams, self.base));
        let (squares, rows) = totals.fold((0.0, 0), |(squares, rows), own| {
            (squares + own.squared_error(&own.solve()), rows + own.rows)
        });
        squares / rows.max(1) as f64
    }

    /// Coefficients by which a session's own parameters, drawn to those of all
    /// sessions, explain the extra columns and y of its Gram `own`.
    #[must_use]
    pub fn explain(&self, own: &Gram) -> DMatrix<f64> {
        own.explain(&self.shared, &self.hold)
    }

    /// Coefficient of the first column of the model's effect that is this `part` of
    /// friction, fitted to all sessions (in the unit of its row); 0 where the
    /// model has no such effect.
    #[must_use]
    pub fn coefficient(&self, prepared: &PreparedModel, part: Part) -> f64 {
        let mut terms = with_columns(&prepared.terms);
        let own = terms.find(|(term, _)| term.effect.row().part == Some(part));
        own.and_then(|(_, columns)| self.shared.get(columns.start).copied())
            .unwrap_or(0.0)
    }

    /// Gram of the rows of all sessions: base columns and y.
    #[must_use]
    pub fn total(&self) -> Gram {
        Gram::sum(self.sessions.iter().flat_map(|s| &s.grams), self.base)
    }

    /// Gram matrices of the model itself, without further columns.
    #[must_use]
    pub fn own(&self) -> BlockGrams {
        self.sessions.iter().map(|s| s.grams.clone()).collect()
    }

    /// Sum over the sessions of `grams` less what each session's own parameters
    /// explain of them: the remainder of the extra columns and of y.
    #[must_use]
    pub fn remainder(&self, grams: &BlockGrams) -> Gram {
        let mut sum: Option<Gram> = None;
        for session in grams {
            let Some(first) = session.first() else {
                continue;
            };
            let total = Gram::sum(session, first.columns());
            let reduced = total.reduce(self.base, &self.explain(&total));
            match &mut sum {
                None => sum = Some(reduced),
                Some(sum) => sum.add(&reduced),
            }
        }
        sum.unwrap_or_else(|| Gram::empty(0))
    }

    /// Filtered columns of another effect: by session, column and row.
    #[must_use]
    pub fn extra_columns(
        &self,
        prepared: &PreparedModel,
        effect: &EffectHandle,
        shape: &[f64],
    ) -> Vec<Vec<Vec<f64>>> {
        prepared
            .sessions
            .iter()
            .map(|signals| {
                let inertia = prepared.facts.inertia.unwrap_or(0.0);
                columns::filtered(
                    signals,
                    &prepared.filters,
                    inertia,
                    effect,
                    shape,
                    &signals.rows,
                )
            })
            .collect()
    }

    /// Gram matrices with the `extra` columns (by session, column and row) inserted
    /// before y.
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
    /// Measured side and columns at the working samples `rows` of one session, in
    /// `count` blocks of time.
    #[must_use]
    pub fn new(prepared: &PreparedModel, signals: &Signals, rows: &[usize], count: usize) -> Self {
        let inertia = prepared.facts.inertia.unwrap_or(0.0);
        let mut measured = columns::measured(signals, &prepared.filters, inertia, rows);
        let mut base = Vec::new();
        for term in &prepared.terms {
            let own = columns::filtered_term(signals, &prepared.filters, inertia, term, rows);
            // The channels are linearised around the compensated coefficients: adding
            // these back, a fit gives the whole coefficient, not its correction.
            for (column, coefficient) in own.iter().zip(&term.compensated) {
                let taken = measured.iter_mut().zip(column);
                taken.for_each(|(measured, value)| *measured += coefficient * value);
            }
            base.extend(own.iter().cloned());
        }
        let blocks = blocks(rows.len(), count);
        let grams = grams(&base, &measured, &blocks);
        let judged = rows.iter();
        let judged = judged.map(|row| signals.unjudged_rows.binary_search(row).is_err());
        Self {
            measured,
            base,
            judged: judged.collect(),
            blocks,
            grams,
        }
    }

    /// The rows with these numbers, in order, in the same blocks of time.
    fn on_rows(&self, rows: &[usize]) -> Self {
        let of = |column: &Vec<f64>| -> Vec<f64> { rows.iter().map(|row| column[*row]).collect() };
        let base: Vec<Vec<f64>> = self.base.iter().map(of).collect();
        let measured = of(&self.measured);
        let place = |row: usize| rows.partition_point(|own| *own < row);
        let blocks = self
            .blocks
            .iter()
            .map(|(from, to)| (place(*from), place(*to)));
        let blocks: Vec<(usize, usize)> = blocks.collect();
        Self {
            grams: grams(&base, &measured, &blocks),
            judged: rows.iter().map(|row| self.judged[*row]).collect(),
            measured,
            base,
            blocks,
        }
    }

    /// Residual of the session fitted by itself, row by row \[Nm\].
    #[must_use]
    pub fn own_residual(&self) -> Vec<f64> {
        let total = Gram::sum(&self.grams, self.base.len());
        self.residual(&total.solve())
    }

    /// Measured less modelled with these `coefficients`, row by row \[Nm\].
    #[must_use]
    pub fn residual(&self, coefficients: &DVector<f64>) -> Vec<f64> {
        let mut residual = self.measured.clone();
        for (column, c) in self.base.iter().zip(coefficients.iter()) {
            residual
                .iter_mut()
                .zip(column)
                .for_each(|(r, x)| *r -= c * x);
        }
        residual
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

/// Gram of each block: columns and y.
fn grams(columns: &[Vec<f64>], measured: &[f64], blocks: &[(usize, usize)]) -> Vec<Gram> {
    let views: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
    let each = blocks.iter();
    each.map(|(from, to)| Gram::from_columns(&views, measured, *from, *to))
        .collect()
}

/// Whether sessions are left out as a whole: of three or more each, of two where
/// neither is too short to predict the other.
fn one_predicts_the_other(sessions: &[SessionDesign]) -> bool {
    let mut rows: Vec<usize> = sessions.iter().map(|s| s.measured.len()).collect();
    rows.retain(|count| *count > 0);
    match rows.as_slice() {
        [] | [_] => false,
        [a, b] => *a.min(b) as f64 >= MIN_SHARE_OF_TWO * (a + b) as f64,
        _ => true,
    }
}

/// Cuts `rows` rows into `count` blocks of equal length, fewer if they are few: what is left out
/// in turn has to leave something to be fitted, and to differ.
fn blocks(rows: usize, count: usize) -> Vec<(usize, usize)> {
    let most = (rows / ROWS_OF_BLOCK).max(FEWEST_BLOCKS.min(rows));
    let count = count.min(most);
    (0..count)
        .map(|b| (b * rows / count, (b + 1) * rows / count))
        .collect()
}
