//! Recordings and model put together, as the regression needs them.

use std::sync::Arc;

use nalgebra::DVector;

use crate::effects::{BoundTerm, EffectHandle, Facts, JointCoupling, Row, with_columns};
use crate::signals::{Filters, Signals};

/// A model bound to recordings: signals filtered, effects with their shapes, the
/// model's own prediction. Fits, tests and simulations start from it;
/// [`prepare`](crate::preparation::prepare()) makes it.
#[derive(Clone)]
pub struct PreparedModel {
    /// Properties of the recordings and of the model that the effects depend on.
    pub facts: Facts,
    /// Whether the temperature varies within sessions by more than the steps that it is read in.
    pub temperature_is_resolved: bool,
    /// Widths of the filters, the same for all sessions.
    pub filters: Filters,
    /// Sessions that the model is fitted to.
    pub sessions: Vec<Signals>,
    /// Sessions that are only predicted; may be empty.
    pub held_out: Vec<Signals>,
    /// The model's effects in the order of their columns; a fitted inertia comes first.
    pub terms: Vec<BoundTerm>,
    /// Whether rows near rest and just after reversals count.
    pub reversals: bool,
    /// Coefficients of the terms that need no prediction, from which the prediction
    /// is made that the other terms act on.
    pub(crate) predicted: DVector<f64>,
}

impl PreparedModel {
    /// Whether the model has the effect `id`.
    #[must_use]
    pub fn has(&self, id: &str) -> bool {
        self.terms.iter().any(|t| t.effect.description().id == id)
    }

    /// Whether an effect counts here: of a second one of its kind, whether the model has the first.
    #[must_use]
    pub fn offers(&self, row: &Row) -> bool {
        row.another.is_none_or(|first| self.has(first))
    }

    /// The model's effect `id`, and the index of its first column.
    #[must_use]
    pub fn first_column(&self, id: &str) -> Option<(&BoundTerm, usize)> {
        let mut terms = with_columns(&self.terms);
        let (term, columns) = terms.find(|(t, _)| t.effect.description().id == id)?;
        Some((term, columns.start))
    }

    /// The effect that other joints of the arm have on this one, where their motions
    /// are recorded.
    #[must_use]
    pub fn coupling(&self) -> Option<EffectHandle> {
        let coupling = JointCoupling::among(self.sessions.first()?.extra.keys())?;
        Some(Arc::new(coupling))
    }

    /// The same model with the rows near rest and just after reversals; of a
    /// contact only while it lasts.
    #[must_use]
    pub fn with_reversals(&self) -> Self {
        let mut whole = self.clone();
        whole.keep_reversals();
        whole
    }

    pub(crate) fn keep_reversals(&mut self) {
        self.reversals = true;
        for signals in self.sessions.iter_mut().chain(&mut self.held_out) {
            signals.rows.clone_from(&signals.rows_with_reversals);
        }
    }

    /// Leaves out the rows whose filters reach a sample at which the torque of an
    /// effect of the model is not determined by what is measured.
    pub(crate) fn leave_out_undetermined_rows(&mut self) {
        let reach = self.filters.column_reach();
        for signals in self.sessions.iter_mut().chain(&mut self.held_out) {
            for term in &self.terms {
                leave_out_undetermined(signals, reach, &term.effect, &term.shape);
            }
        }
        self.find_unjudged_rows();
    }

    /// The same model without the rows whose filters reach a sample at which the torque of
    /// `effect`, which it lacks, is not determined by what is measured.
    #[must_use]
    pub(crate) fn without_undetermined(mut self, effect: &EffectHandle, shape: &[f64]) -> Self {
        let reach = self.filters.column_reach();
        for signals in self.sessions.iter_mut().chain(&mut self.held_out) {
            leave_out_undetermined(signals, reach, effect, shape);
        }
        self
    }

    /// Notes the rows whose filters reach a sample at which the measured torque is
    /// not the motor's, by an effect of the model.
    fn find_unjudged_rows(&mut self) {
        let reach = self.filters.column_reach();
        for signals in self.sessions.iter_mut().chain(&mut self.held_out) {
            let each = self.terms.iter();
            let samples: Vec<Vec<usize>> = each
                .map(|term| (term.effect).unjudged_samples(&term.shape, &signals.points))
                .filter(|samples| !samples.is_empty())
                .collect();
            let is_reached = |row: &&usize| samples.iter().any(|own| reaches(**row, reach, own));
            signals.unjudged_rows = signals.rows.iter().filter(is_reached).copied().collect();
        }
    }

    /// Rows of each session: those fitted, then those held out.
    pub fn rows(&self) -> impl Iterator<Item = &[usize]> {
        let all = self.sessions.iter().chain(&self.held_out);
        all.map(|signals| signals.rows.as_slice())
    }

    /// The same model on the rows of `other`, which has the same sessions; of these
    /// the same count for errors.
    #[must_use]
    pub fn on_rows_of(mut self, other: &Self) -> Self {
        let own = self.sessions.iter_mut().chain(&mut self.held_out);
        let theirs = other.sessions.iter().chain(&other.held_out);
        for (own, theirs) in own.zip(theirs) {
            own.rows.clone_from(&theirs.rows);
            own.unjudged_rows.clone_from(&theirs.unjudged_rows);
        }
        self
    }
}

/// Whether the filters of `row`, which look `reach` samples to either side, reach one
/// of `samples`, which are in order.
fn reaches(row: usize, reach: usize, samples: &[usize]) -> bool {
    let after = samples.partition_point(|at| at + reach < row);
    samples.get(after).is_some_and(|at| *at <= row + reach)
}

/// Leaves out the rows of a session whose filters, which look `reach` samples to either side, reach
/// one at which the torque of `effect` is not determined by what is measured.
fn leave_out_undetermined(
    signals: &mut Signals,
    reach: usize,
    effect: &EffectHandle,
    shape: &[f64],
) {
    let samples = effect.undetermined_samples(shape, &signals.points);
    signals.rows.retain(|row| !reaches(*row, reach, &samples));
}
