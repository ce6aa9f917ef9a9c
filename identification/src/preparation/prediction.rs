//! The model's own prediction of load, friction and motor torque, for effects that
//! are functions of it.

use std::sync::Arc;

use nalgebra::DVector;

use crate::design::columns::{self, OtherVelocity};
use crate::design::{Design, PreparedModel};
use crate::effects::{BoundTerm, EffectHandle, Row, with_columns};
use crate::signals::{Columns, Signals};

/// Fits of a model whose effects act on its own prediction, at most, …
const MAX_FITS: usize = 20;
/// … and none after one that moves no parameter by this share of its standard error.
const MIN_STEP_IN_STD_ERRORS: f64 = 0.02;
/// Largest factor by which relaxation lengthens a step.
const MAX_RELAXATION: f64 = 20.0;

impl PreparedModel {
    /// Models the load of a joint without a torque sensor: inertia, gravity and
    /// spring by the model's own fit.
    pub(super) fn model_load(&mut self) {
        if self.facts.joint_torque || self.facts.joint.is_contact() {
            return;
        }
        // Where nothing is fitted by the load, once is enough.
        let rounds = if self.is_of_motion() { 1 } else { 2 };
        let mut before: Option<DVector<f64>> = None;
        for _ in 0..rounds {
            let coefficients = Design::new(self).shared;
            if before.as_ref() == Some(&coefficients) {
                break;
            }
            let (inertia, terms) = (self.facts.inertia, &self.terms);
            for signals in self.sessions.iter_mut().chain(&mut self.held_out) {
                let mut loads = working(signals, terms, &coefficients, |effect| {
                    effect.row().is_modelled_load()
                });
                for (load, point) in loads.iter_mut().zip(signals.points.iter()) {
                    *load += inertia.unwrap_or(0.0) * point.acceleration;
                }
                let rates = slope(&loads, signals.period);
                let jerks = slope(&rates, signals.period);
                let points = Arc::make_mut(&mut signals.points).iter_mut();
                for (point, (load, (rate, jerk))) in
                    points.zip(loads.iter().zip(rates.iter().zip(jerks)))
                {
                    (point.load, point.load_rate, point.load_jerk) = (*load, *rate, jerk);
                }
            }
            before = Some(coefficients);
        }
    }

    /// Whether no term of the model depends on the load, or on the model's own prediction.
    pub(super) fn is_of_motion(&self) -> bool {
        self.terms.iter().all(|term| term.effect.is_of_motion())
    }

    /// Makes the prediction for effects that act on it. These effects are fitted
    /// together with the others, but are no part of the prediction; all are fitted
    /// again until it does not change.
    pub(super) fn predict(&mut self) {
        self.predict_if_read(true);
    }

    /// The same; of a prediction that is not read only the coefficients.
    pub(super) fn predict_if_read(&mut self, is_read: bool) {
        let mut own = self.terms.clone();
        own.retain(|t| !t.effect.row().needs_prediction);
        let all = std::mem::replace(&mut self.terms, own.clone());
        let mut predicted = Design::new(self).shared;
        self.terms = all;
        let mut acting = self.terms.iter();
        let mut acting = acting.by_ref().filter(|t| t.effect.row().needs_prediction);
        // What is taken out of the channels is fitted by columns that do not read it.
        let acts = acting.any(|t| t.compensated.is_empty());
        if own.len() == self.terms.len() {
            self.write_if(is_read, &predicted, &own);
            return;
        }
        if acts {
            self.write_prediction(&predicted, &own);
        }
        // Where a prediction depends strongly on itself, as where a sensor is
        // clipped, fixed-point iteration converges slowly: Aitken's relaxation
        // extrapolates two steps.
        let mut before: Option<DVector<f64>> = None;
        let mut stride = 1.0;
        for _ in 0..MAX_FITS {
            let together = Design::new(self);
            let kept = self.predicting_columns();
            let error = |k: &usize| together.covariance[(*k, *k)].max(1e-300).sqrt();
            let step = DVector::from_iterator(
                kept.len(),
                (kept.iter().zip(&predicted))
                    .map(|(k, own)| (together.shared[*k] - own) / error(k)),
            );
            if let Some(before) = &before {
                let change = &step - before;
                let along = -stride * before.dot(&change) / change.norm_squared().max(1e-300);
                stride = along.clamp(1.0, MAX_RELAXATION);
            }
            for ((own, step), k) in predicted.iter_mut().zip(&step).zip(&kept) {
                *own += stride * step * error(k);
            }
            self.write_if(is_read || acts, &predicted, &own);
            if step.amax() < MIN_STEP_IN_STD_ERRORS {
                return;
            }
            before = Some(step);
        }
    }

    fn write_if(&mut self, is_read: bool, coefficients: &DVector<f64>, terms: &[BoundTerm]) {
        match is_read {
            true => self.write_prediction(coefficients, terms),
            false => self.predicted.clone_from(coefficients),
        }
    }

    /// Columns of the terms that need no prediction.
    fn predicting_columns(&self) -> Vec<usize> {
        with_columns(&self.terms)
            .filter(|(term, _)| !term.effect.row().needs_prediction)
            .flat_map(|(_, columns)| columns)
            .collect()
    }

    /// Writes the prediction with these coefficients into the points of all sessions.
    fn write_prediction(&mut self, coefficients: &DVector<f64>, terms: &[BoundTerm]) {
        self.predicted.clone_from(coefficients);
        let sensor = self.facts.joint_torque;
        let first_of = |is: fn(&Row) -> bool| {
            let (_, columns) = with_columns(terms).find(|(term, _)| is(term.effect.row()))?;
            coefficients.get(columns.start).copied()
        };
        let given = self.facts.inertia;
        let inertia = given.or_else(|| first_of(|row| row.is_inertia));
        let (given, inertia) = (given.unwrap_or(0.0), inertia.unwrap_or(0.0));
        let load_slope = first_of(Row::is_load_coulomb).unwrap_or(0.0);
        let is_friction = |effect: &EffectHandle| !effect.row().is_inertia;
        let nudge = 1e-3 * self.facts.speed[1];
        for signals in self.sessions.iter_mut().chain(&mut self.held_out) {
            let friction = working(signals, terms, coefficients, is_friction);
            let inertial = working(signals, terms, coefficients, |effect| !is_friction(effect));
            let friction_at = |velocity: OtherVelocity| {
                sum_of(signals, terms, coefficients, is_friction, |term| {
                    columns::at_velocity(signals, &term.effect, &term.shape, velocity)
                })
            };
            let faster = friction_at(OtherVelocity::Faster(nudge));
            let slowest = friction_at(OtherVelocity::AboveRest(nudge));
            for (at, point) in Arc::make_mut(&mut signals.points).iter_mut().enumerate() {
                point.friction_predicted = friction[at];
                point.friction_level = slowest[at].abs();
                point.load_slope = load_slope;
                point.inertia = inertia;
                point.friction_slope = if nudge > 0.0 {
                    point.sign() * (faster[at] - friction[at]) / nudge
                } else {
                    0.0
                };
                point.motor_predicted = friction[at]
                    + inertial[at]
                    + given * point.acceleration
                    + if sensor { point.load } else { 0.0 };
            }
        }
    }
}

/// Sum of coefficients times columns at the working rate, of some effects.
pub(super) fn working(
    signals: &Signals,
    terms: &[BoundTerm],
    coefficients: &DVector<f64>,
    which: impl Fn(&EffectHandle) -> bool,
) -> Vec<f64> {
    sum_of(signals, terms, coefficients, which, |term| {
        columns::kept(signals, &term.effect, &term.shape)
    })
}

/// The same of columns as they are told.
fn sum_of(
    signals: &Signals,
    terms: &[BoundTerm],
    coefficients: &DVector<f64>,
    which: impl Fn(&EffectHandle) -> bool,
    columns_of: impl Fn(&BoundTerm) -> Columns,
) -> Vec<f64> {
    let mut sum = vec![0.0; signals.points.len()];
    for (term, places) in with_columns(terms).filter(|(term, _)| which(&term.effect)) {
        for (k, column) in places.zip(columns_of(term).iter()) {
            let c = coefficients.get(k).copied().unwrap_or(0.0);
            sum.iter_mut().zip(column).for_each(|(s, x)| *s += c * x);
        }
    }
    sum
}

/// Central differences.
fn slope(signal: &[f64], period: f64) -> Vec<f64> {
    let last = signal.len().saturating_sub(1);
    (0..signal.len())
        .map(|at| {
            let (before, after) = (at.saturating_sub(1), (at + 1).min(last));
            let span = (after - before).max(1) as f64 * period;
            (signal[after] - signal[before]) / span
        })
        .collect()
}
