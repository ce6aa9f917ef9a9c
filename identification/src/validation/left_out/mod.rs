//! The error that is reported: on rows left out, with parameters shared by all
//! sessions; and whether one model's is lower than another's.
//!
//! Left out are the recordings named for it, else whole sessions in turn, else
//! blocks of time in turn ([`Design::left_out`]). Rankings, what is printed and
//! what is accepted rest on this one number.

use serde::Serialize;

use crate::design::{Design, PreparedModel, SessionDesign};
use crate::numerics::gram::Gram;

/// Residuals on rows left out that count for errors, block of time by block \[Nm\].
#[derive(Clone, Debug, PartialEq)]
pub struct LeftOut {
    blocks: Vec<Vec<f64>>,
}

impl LeftOut {
    /// Of the recordings that are held out; where there are none, of folds.
    #[must_use]
    pub fn new(prepared: &PreparedModel, design: &Design) -> Self {
        if prepared.held_out.is_empty() {
            return Self::of_folds(design);
        }
        Self::of_held_out(prepared, |_, session| session.residual(&design.shared))
    }

    /// Of the recordings that are held out, whose residuals `residual` returns: it is
    /// given each with its number.
    pub fn of_held_out(
        prepared: &PreparedModel,
        residual: impl Fn(usize, &SessionDesign) -> Vec<f64>,
    ) -> Self {
        let count = Design::blocks_per_session(prepared.held_out.len());
        let mut blocks = Vec::new();
        for (at, signals) in prepared.held_out.iter().enumerate() {
            let session = SessionDesign::new(prepared, signals, &signals.rows, count);
            let residual = residual(at, &session);
            let each = session.blocks.iter();
            blocks.extend(each.map(|block| judged(&session, &residual, *block)));
        }
        Self { blocks }
    }

    /// Of what is left out in turn of the sessions that are fitted.
    #[must_use]
    pub fn of_folds(design: &Design) -> Self {
        let total = design.total();
        Self::of_folds_by(design, |fold| {
            let gram = |(s, b): &(usize, usize)| design.sessions.get(*s)?.grams.get(*b);
            let out = Gram::sum(fold.iter().filter_map(gram), design.base);
            let coefficients = total.without(&out).solve();
            move |_: usize, session: &SessionDesign| session.residual(&coefficients)
        })
    }

    /// The same, where `without` fits to all but a fold: it returns the residuals of a
    /// session, which it is given with its number.
    pub fn of_folds_by<R: Fn(usize, &SessionDesign) -> Vec<f64>>(
        design: &Design,
        mut without: impl FnMut(&[(usize, usize)]) -> R,
    ) -> Self {
        let mut blocks = Vec::new();
        for fold in &design.left_out {
            let residual_of = without(fold);
            let mut last = None;
            for (s, b) in fold {
                let Some(session) = design.sessions.get(*s) else {
                    continue;
                };
                let residual = match last.take() {
                    Some((of, residual)) if of == *s => residual,
                    _ => residual_of(*s, session),
                };
                blocks.extend((session.blocks.get(*b)).map(|at| judged(session, &residual, *at)));
                last = Some((*s, residual));
            }
        }
        Self { blocks }
    }

    /// Whether these are on rows of which the other has as many, block by block.
    #[must_use]
    pub fn has_rows_of(&self, other: &Self) -> bool {
        let lengths = |own: &Self| own.blocks.iter().map(Vec::len).collect::<Vec<_>>();
        lengths(self) == lengths(other)
    }

    /// Root mean square \[Nm\].
    #[must_use]
    pub fn rms(&self) -> f64 {
        let rows: usize = self.blocks.iter().map(Vec::len).sum();
        (square(self.blocks.iter().flatten()) / rows.max(1) as f64).sqrt()
    }

    /// How much lower this error is than `before`, which is on the same rows.
    #[must_use]
    pub fn decrease_from(&self, before: &Self) -> Decrease {
        // With p the difference of the two predictions and r the residual before,
        // the square falls by Σ (2 p r − p²): by more than nothing where the slope
        // of r over p is above a half.
        let products: Vec<(f64, f64)> = (before.blocks.iter().zip(&self.blocks))
            .map(|(before, after)| {
                let both = || before.iter().zip(after);
                let with_residual = both().map(|(b, a)| (b - a) * b).sum();
                (with_residual, both().map(|(b, a)| (b - a).powi(2)).sum())
            })
            .collect();
        let (along, own) = (products.iter()).fold((0.0, 0.0), |sum: (f64, f64), product| {
            (sum.0 + product.0, sum.1 + product.1)
        });
        let slope = if own > 0.0 { along / own } else { 0.0 };
        let count = products.len() as f64;
        let spread: f64 = (products.iter())
            .map(|(along, own)| (along - slope * own).powi(2))
            .sum();
        let error = (spread * count / (count - 1.0).max(1.0)).sqrt();
        let rows: usize = self.blocks.iter().map(Vec::len).sum();
        Decrease {
            before: before.rms(),
            after: self.rms(),
            mean_square: (2.0 * along - own) / rows.max(1) as f64,
            std_error: 2.0 * error / rows.max(1) as f64,
        }
    }
}

/// Decrease of the error on rows left out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Decrease {
    /// Root mean square before \[Nm\].
    pub before: f64,
    /// After \[Nm\].
    pub after: f64,
    /// Decrease of the mean square \[Nm²\].
    pub mean_square: f64,
    /// Its standard error by blocks of time \[Nm²\].
    pub std_error: f64,
}

impl Decrease {
    /// Whether the error falls by more than its own uncertainty.
    #[must_use]
    pub fn is_certain(&self) -> bool {
        self.mean_square > 0.0 && self.mean_square > MIN_DECREASE_IN_STD_ERRORS * self.std_error
    }

    /// Share of the mean square before, and its standard error.
    #[must_use]
    pub fn share(&self) -> [f64; 2] {
        let square = self.before.powi(2).max(1e-300);
        [self.mean_square / square, self.std_error / square]
    }
}

/// Smallest decrease that is accepted, in standard errors.
const MIN_DECREASE_IN_STD_ERRORS: f64 = 2.0;

/// Residuals of the rows of a block that count for errors.
fn judged(session: &SessionDesign, residual: &[f64], (from, to): (usize, usize)) -> Vec<f64> {
    let rows = residual.iter().zip(&session.judged);
    let rows = rows.take(to).skip(from).filter(|(_, counts)| **counts);
    rows.map(|(residual, _)| *residual).collect()
}

fn square<'a>(numbers: impl Iterator<Item = &'a f64>) -> f64 {
    numbers.map(|number| number * number).sum()
}

#[cfg(test)]
mod tests;
