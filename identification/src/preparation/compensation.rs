//! Compensation of the channels for effects that act on what is measured: a
//! channel stamped late, a position measured behind a spring.
//!
//! A column is the first-order influence of such an effect on the torque balance.
//! Where the effect is large, it is taken out of the channels, and the balance is
//! linearised again around the coefficients reached (Gauss-Newton method).

use std::iter::repeat;
use std::sync::Arc;

use nalgebra::DVector;

use crate::design::{Design, PreparedModel};
use crate::effects::{BoundTerm, with_columns};
use crate::signals::{Channels, InvalidSamples, Signals};

use super::prediction::working;

/// Steps, whole or halved, at most, …
const MAX_STEPS: usize = 10;
/// … and none after one that is shorter than this share of a standard error, …
const MIN_STEP_IN_STD_ERRORS: f64 = 0.2;
/// … or than this share of the whole one.
const MIN_STEP_SHARE: f64 = 0.2;
/// Smallest share of the rows that a step keeps: a delay taken out of a channel
/// makes samples at the end invalid.
const MIN_KEPT_SHARE: f64 = 0.9;
/// Share of a coefficient over which the columns are difference quotients.
const NUDGE: f64 = 1e-3;

impl PreparedModel {
    /// Compensates the channels for the model's effects that act on them, if that
    /// leaves a smaller error than their columns do, each at that of its alternative shapes
    /// that leaves the least. Load and prediction are made anew where they are read.
    pub(super) fn compensate(&mut self, is_read: bool) {
        if !self.terms.iter().any(|t| t.effect.row().acts_on_channels) {
            return;
        }
        let mut others = Vec::new();
        for (at, term) in self.terms.iter().enumerate() {
            for shape in term.effect.alternatives(&term.shape, &self.facts) {
                let mut other = self.clone();
                other.terms[at].shape = shape;
                others.push(other);
            }
        }
        self.compensate_at_these_shapes(is_read);
        if others.is_empty() {
            return;
        }
        let mut least = remainder(&Design::new(self)).0;
        for mut other in others {
            other.compensate_at_these_shapes(is_read);
            let (left, _) = remainder(&Design::new(&other));
            if left < least {
                (*self, least) = (other, left);
            }
        }
    }

    fn compensate_at_these_shapes(&mut self, is_read: bool) {
        let mut design = Design::new(self);
        let (mut error, rows) = remainder(&design);
        let mut share = 1.0;
        for _ in 0..MAX_STEPS {
            if share < MIN_STEP_SHARE || self.is_settled(&design) {
                return;
            }
            let Some(next) = self.next(&design.shared, share) else {
                return;
            };
            let mut tried = self.clone();
            tried.compensate_with(&next, is_read);
            let then = Design::new(&tried);
            let (after, kept) = remainder(&then);
            if after < error && kept as f64 > MIN_KEPT_SHARE * rows as f64 {
                (*self, design, error, share) = (tried, then, after, 1.0);
            } else {
                share *= 0.5;
            }
        }
    }

    /// Coefficients of each effect that acts on channels, `share` of the way to the
    /// fitted ones; none for other effects. `None` where they are not plausible.
    fn next(&self, fitted: &DVector<f64>, share: f64) -> Option<Vec<Vec<f64>>> {
        let each = with_columns(&self.terms).map(|(term, columns)| {
            if !term.effect.row().acts_on_channels {
                return Some(Vec::new());
            }
            let before = term.compensated.iter().copied().chain(repeat(0.0));
            let next: Vec<f64> = columns
                .zip(before)
                .map(|(k, before)| before + share * (fitted[k] - before))
                .collect();
            term.effect.plausible(&term.shape, &next).then_some(next)
        });
        each.collect()
    }

    /// Whether the channels are compensated with the fitted coefficients.
    fn is_settled(&self, design: &Design) -> bool {
        with_columns(&self.terms).all(|(term, mut columns)| {
            let settled = columns.by_ref().zip(&term.compensated).all(|(k, before)| {
                let error = design.covariance[(k, k)].max(0.0).sqrt();
                (design.shared[k] - before).abs() <= MIN_STEP_IN_STD_ERRORS * error
            });
            settled && (!term.effect.row().acts_on_channels || !term.compensated.is_empty())
        })
    }

    /// Compensates the channels with these `coefficients`, one vector for each term.
    fn compensate_with(&mut self, coefficients: &[Vec<f64>], is_read: bool) {
        for (term, own) in self.terms.iter_mut().zip(coefficients) {
            term.compensated.clone_from(own);
        }
        for signals in self.sessions.iter_mut().chain(&mut self.held_out) {
            let (channels, lost) = compensated(&self.terms, signals);
            signals.jacobians.clear();
            signals.replace_channels(channels, lost, &self.filters);
        }
        if self.reversals {
            self.keep_reversals();
        }
        if is_read {
            self.model_load();
        }
        self.predict_if_read(is_read);
        self.differentiate();
    }

    /// Columns of the effects that are compensated: derivatives of the torque balance
    /// by their coefficients.
    fn differentiate(&mut self) {
        let mut own = self.terms.clone();
        own.retain(|t| !t.effect.row().needs_prediction);
        let (facts, predicted) = (&self.facts, &self.predicted);
        let inertia = facts.inertia.unwrap_or(0.0);
        // τ + J q̈ + τ_F − τ_m.
        let balance = |signals: &Signals| -> Vec<f64> {
            let friction = working(signals, &own, predicted, |_| true);
            let points = signals.points.iter().zip(friction);
            points
                .map(|(point, friction)| {
                    let load = if facts.joint_torque { point.load } else { 0.0 };
                    load + inertia * point.acceleration + friction - point.motor_torque
                })
                .collect()
        };
        let nudged = |signals: &Signals, terms: &[BoundTerm]| {
            let (channels, lost) = compensated(terms, signals);
            let mut nudged = signals.clone();
            nudged.replace_channels(channels, lost, &self.filters);
            if !facts.joint_torque {
                let points = Arc::make_mut(&mut nudged.points).iter_mut();
                for (point, known) in points.zip(signals.points.iter()) {
                    point.load = known.load;
                }
            }
            balance(&nudged)
        };
        for signals in self.sessions.iter_mut().chain(&mut self.held_out) {
            let before = balance(signals);
            for (at, term) in self.terms.iter().enumerate() {
                let mut columns = Vec::new();
                for (k, coefficient) in term.compensated.iter().enumerate() {
                    let nudge = NUDGE * coefficient.abs().max(1e-9);
                    let mut terms = self.terms.clone();
                    terms[at].compensated[k] += nudge;
                    let after = nudged(signals, &terms);
                    let both = after.iter().zip(&before);
                    columns.push(
                        both.map(|(after, before)| (after - before) / nudge)
                            .collect(),
                    );
                }
                if !columns.is_empty() {
                    let id = term.effect.description().id.clone();
                    signals.jacobians.insert(id, columns);
                }
            }
        }
    }
}

/// The channels of a session compensated for `terms`, and the samples that are invalid then.
fn compensated(terms: &[BoundTerm], signals: &Signals) -> (Channels, InvalidSamples) {
    let mut channels = Channels::clone(&signals.recorded);
    let mut lost = InvalidSamples::default();
    for term in terms.iter().filter(|t| !t.compensated.is_empty()) {
        let points = &signals.points;
        lost += (term.effect).compensate(&term.shape, &term.compensated, &mut channels, points);
    }
    (channels, lost)
}

/// Mean square \[Nm²\] that the model leaves, each session with its own parameters,
/// and the number of rows.
fn remainder(design: &Design) -> (f64, usize) {
    let remainder = design.remainder(&design.own());
    (
        remainder.square() / remainder.rows.max(1) as f64,
        remainder.rows,
    )
}
