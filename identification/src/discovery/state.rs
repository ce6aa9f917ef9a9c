//! How far a search has come.

use super::rows::{Rows, extend_basis, square, take_out};
use super::shape::Shape;
use super::term::Term;

/// Terms, and what they leave of the residual.
#[derive(Clone)]
pub(super) struct State {
    pub(super) terms: Vec<Term>,
    /// What is left \[Nm\], row by row.
    pub(super) residual: Vec<f64>,
    /// Orthonormal columns of the terms.
    pub(super) basis: Vec<Vec<f64>>,
    /// Sum of squares that is left \[Nm²\].
    pub(super) error: f64,
    /// Of the least certain of its terms, for all that was searched.
    pub(super) p_value: f64,
}

impl State {
    /// No term yet.
    pub(super) fn empty(rows: &Rows) -> Self {
        Self {
            terms: Vec::new(),
            residual: rows.residual.clone(),
            basis: Vec::new(),
            error: square(&rows.residual),
            p_value: 0.0,
        }
    }

    /// With these terms; `None` where one of them is nothing here.
    pub(super) fn of(rows: &Rows, terms: Vec<Term>, p_value: f64) -> Option<Self> {
        let mut basis = Vec::new();
        for term in &terms {
            extend_basis(&mut basis, rows.column_of(term)?);
        }
        let mut residual = rows.residual.clone();
        take_out(&basis, &mut residual);
        let error = square(&residual);
        (basis.len() == terms.len() && error.is_finite()).then_some(Self {
            terms,
            residual,
            basis,
            error,
            p_value,
        })
    }

    pub(super) fn complexity(&self) -> usize {
        self.terms.iter().map(Term::complexity).sum::<usize>() + self.terms.len() - 1
    }

    /// Signals and functions of all terms.
    pub(super) fn structure(&self) -> Vec<(bool, Vec<(usize, Shape)>)> {
        let mut all: Vec<_> = self.terms.iter().map(Term::structure).collect();
        all.sort_unstable();
        all
    }
}
