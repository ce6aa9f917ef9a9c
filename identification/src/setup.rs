//! Recordings and model put together: signals ready, effects bound, facts known.

use std::sync::Arc;

use nalgebra::DVector;

use crate::check::check;
use crate::data::{Dataset, Inertia, ModelSpec, Term};
use crate::design::{Design, columns};
use crate::effects::{self, EffectHandle, Facts, Point};
use crate::error::PrepareError;
use crate::expression::Compiled;
use crate::refine;
use crate::signals::{Filters, RESOLVED, Signals, quantile};

/// An effect of the model with the shape it has.
#[derive(Clone)]
pub struct BoundTerm {
    /// The effect.
    pub effect: EffectHandle,
    /// Its shape parameters.
    pub shape: Vec<f64>,
}

/// Everything that fits and tests start from.
pub struct Setup {
    /// What is known of the recordings.
    pub facts: Facts,
    /// Widths of filters.
    pub filters: Filters,
    /// Sessions to fit.
    pub sessions: Vec<Signals>,
    /// Sessions only to predict.
    pub held_out: Vec<Signals>,
    /// The model's effects; a fitted inertia comes first.
    pub terms: Vec<BoundTerm>,
}

impl Setup {
    /// Checks, smooths, binds, and finds shapes and modelled load.
    ///
    /// # Errors
    ///
    /// See [`PrepareError`].
    pub fn new(dataset: &Dataset, spec: &ModelSpec) -> Result<Self, PrepareError> {
        check(dataset, spec)?;
        let filters = Filters::of(dataset);
        let mut sessions: Vec<Signals> = dataset
            .sessions
            .iter()
            .map(|s| Signals::new(s, &filters))
            .collect();
        let mut held_out: Vec<Signals> = dataset
            .held_out
            .iter()
            .map(|s| Signals::new(s, &filters))
            .collect();
        let facts = gather(dataset, spec, &sessions, &filters);
        for signals in sessions.iter_mut().chain(&mut held_out) {
            for point in &mut signals.points {
                if facts.temperature {
                    point.temperature -= facts.reference_temperature;
                }
            }
        }
        let mut setup = Self {
            facts,
            filters,
            sessions,
            held_out,
            terms: Vec::new(),
        };
        setup.terms = setup.bind(spec)?;
        if setup.terms.iter().any(|t| t.effect.shows_at_turns()) {
            setup.keep_reversals();
        }
        let parameters = setup.terms.iter().map(|t| t.effect.columns()).sum();
        let rows = setup.sessions.iter().map(|s| s.rows.len()).sum();
        if rows < 20 + 5 * parameters {
            return Err(PrepareError::NothingExcited { rows, parameters });
        }
        let is_load_modelled = !setup.facts.joint_torque && !dataset.joint.is_contact();
        if is_load_modelled {
            setup.model_load();
        }
        setup.find_shapes();
        if is_load_modelled {
            setup.model_load();
        }
        setup.predict();
        Ok(setup)
    }

    fn bind(&self, spec: &ModelSpec) -> Result<Vec<BoundTerm>, PrepareError> {
        let mut terms: Vec<BoundTerm> = Vec::new();
        if spec.inertia == Inertia::Fit {
            terms.push(BoundTerm {
                effect: Arc::new(effects::FittedInertia::default()),
                shape: Vec::new(),
            });
        }
        for term in &spec.effects {
            let effect = self.resolve(term)?;
            let id = &effect.description().id;
            if terms.iter().any(|t| &t.effect.description().id == id) {
                return Err(PrepareError::Twice(id.clone()));
            }
            if let Some(why) = effect.unavailable(&self.facts) {
                return Err(PrepareError::Unavailable {
                    id: id.clone(),
                    why,
                });
            }
            // A start for the search: the middle of the grid, else of the bounds.
            let shapes = effect.shapes(&self.facts);
            let bounds = effect.bounds(&self.facts);
            let shape = match shapes.get(shapes.len() / 2) {
                Some(shape) if !shape.is_empty() || bounds.is_empty() => shape.clone(),
                _ => bounds.iter().map(|b| 0.5 * (b[0] + b[1])).collect(),
            };
            terms.push(BoundTerm { effect, shape });
        }
        Ok(terms)
    }

    /// The effect that a term names.
    ///
    /// # Errors
    ///
    /// An unknown id, or an expression that cannot be used on these recordings.
    pub fn resolve(&self, term: &Term) -> Result<EffectHandle, PrepareError> {
        match term {
            Term::Catalogue(id) => self.in_catalogue(id),
            Term::Custom(custom) => Ok(Arc::new(Compiled::new(
                custom,
                &self.facts,
                &self.sessions,
            )?)),
        }
    }

    fn in_catalogue(&self, id: &str) -> Result<EffectHandle, PrepareError> {
        let subject = self.facts.joint.subject();
        match effects::find(id) {
            Some(effect) if effect.description().of == subject => Ok(effect),
            Some(effect) => Err(PrepareError::OtherSubject {
                id: id.to_owned(),
                of: effect.description().of,
                recorded: subject,
            }),
            None => Err(PrepareError::UnknownEffect {
                id: id.to_owned(),
                known: effects::of(subject)
                    .iter()
                    .map(|e| e.description().id.clone())
                    .collect::<Vec<_>>()
                    .join(", "),
            }),
        }
    }

    /// Whether the model has an effect of this id.
    #[must_use]
    pub fn has(&self, id: &str) -> bool {
        self.terms.iter().any(|t| t.effect.description().id == id)
    }

    /// First coefficient of the model's effect `id`, fitted to everything; 0
    /// where the model does not have it.
    #[must_use]
    pub fn coefficient(&self, id: &str) -> f64 {
        let mut at = 0;
        for term in &self.terms {
            if term.effect.description().id == id {
                let all = Design::new(self).total().solve();
                return all.get(at).copied().unwrap_or(0.0);
            }
            at += term.effect.columns();
        }
        0.0
    }

    /// The same with the rows near rest and just after reversals; of a contact
    /// only while it lasts.
    #[must_use]
    pub fn with_reversals(&self) -> Self {
        let mut whole = Self {
            facts: self.facts.clone(),
            filters: self.filters,
            sessions: self.sessions.clone(),
            held_out: self.held_out.clone(),
            terms: self.terms.clone(),
        };
        whole.keep_reversals();
        whole
    }

    fn keep_reversals(&mut self) {
        for signals in self.sessions.iter_mut().chain(&mut self.held_out) {
            signals.rows.clone_from(&signals.turning_rows);
        }
    }

    /// Finds the shape of the model's own effects, one after the other, twice:
    /// one depends on the others', and on what they predict.
    fn find_shapes(&mut self) {
        let searched: Vec<usize> = (0..self.terms.len())
            .filter(|i| !self.terms[*i].shape.is_empty())
            .collect();
        let predicts = self.terms.iter().any(|t| t.effect.needs_prediction());
        let rounds = if searched.len() > 1 || predicts { 2 } else { 1 };
        for _ in 0..rounds {
            for &at in &searched {
                if self.terms[at].effect.needs_prediction() {
                    self.predict();
                }
                let term = self.terms.remove(at);
                let design = Design::new(self);
                let shape = refine::search(self, &design, &term.effect);
                self.terms.insert(
                    at,
                    BoundTerm {
                        effect: term.effect,
                        shape: shape.unwrap_or(term.shape),
                    },
                );
            }
        }
    }

    /// Without a torque sensor the load is what inertia, gravity and spring
    /// take by the model's own fit.
    fn model_load(&mut self) {
        for _ in 0..2 {
            let design = Design::new(self);
            let coefficients = design.total().solve();
            let (inertia, terms) = (self.facts.inertia, &self.terms);
            for signals in self.sessions.iter_mut().chain(&mut self.held_out) {
                let load = working(signals, terms, &coefficients, |effect| {
                    effect.is_load() || effect.description().id == "inertia_fit"
                });
                for (point, load) in signals.points.iter_mut().zip(load) {
                    point.load = load + inertia.unwrap_or(0.0) * point.acceleration;
                }
                let loads: Vec<f64> = signals.points.iter().map(|p| p.load).collect();
                let rates = slope(&loads, signals.period);
                let jerks = slope(&rates, signals.period);
                for (point, (rate, jerk)) in signals.points.iter_mut().zip(rates.iter().zip(jerks))
                {
                    (point.load_rate, point.load_jerk) = (*rate, jerk);
                }
            }
        }
    }

    /// What the model predicts, for effects that act on it. These effects
    /// themselves are fitted along, but are no part of the prediction.
    pub(crate) fn predict(&mut self) {
        let mut own = self.terms.clone();
        own.retain(|t| !t.effect.needs_prediction());
        let all = std::mem::replace(&mut self.terms, own.clone());
        let first = Design::new(self).total().solve();
        self.spread(&first, &own);
        self.terms = all;
        if own.len() < self.terms.len() {
            let together = Design::new(self).total().solve();
            let mut at = 0;
            let mut kept = Vec::new();
            for term in &self.terms {
                let columns = term.effect.columns();
                if !term.effect.needs_prediction() {
                    kept.extend((at..at + columns).map(|i| together[i]));
                }
                at += columns;
            }
            self.spread(&DVector::from_vec(kept), &own);
        }
    }

    fn spread(&mut self, coefficients: &DVector<f64>, terms: &[BoundTerm]) {
        let (inertia, sensor) = (self.facts.inertia.unwrap_or(0.0), self.facts.joint_torque);
        let mut before = 0;
        let mut load_slope = 0.0;
        for term in terms {
            if term.effect.description().id == "load_coulomb" {
                load_slope = coefficients.get(before).copied().unwrap_or(0.0);
            }
            before += term.effect.columns();
        }
        let nudge = 1e-3 * self.facts.speed[1];
        for signals in self.sessions.iter_mut().chain(&mut self.held_out) {
            let friction = working(signals, terms, coefficients, |e| {
                e.description().id != "inertia_fit"
            });
            let total = working(signals, terms, coefficients, |_| true);
            let mut other = signals.clone();
            let mut friction_at = |velocity: fn(&Point, f64) -> f64| {
                for (point, measured) in other.points.iter_mut().zip(&signals.points) {
                    point.velocity = velocity(measured, nudge);
                }
                working(&other, terms, coefficients, |e| {
                    e.description().id != "inertia_fit"
                })
            };
            let faster = friction_at(|point, nudge| point.velocity + nudge * point.sign());
            let slowest = friction_at(|point, nudge| nudge * point.sign());
            for (at, point) in signals.points.iter_mut().enumerate() {
                point.friction_predicted = friction[at];
                point.friction_level = slowest[at].abs();
                point.load_slope = load_slope;
                point.friction_slope = if nudge > 0.0 {
                    point.sign() * (faster[at] - friction[at]) / nudge
                } else {
                    0.0
                };
                point.motor_predicted = total[at]
                    + inertia * point.acceleration
                    + if sensor { point.load } else { 0.0 };
            }
        }
    }
}

/// Sum of coefficients times columns at the working rate, of some effects.
fn working(
    signals: &Signals,
    terms: &[BoundTerm],
    coefficients: &DVector<f64>,
    which: impl Fn(&EffectHandle) -> bool,
) -> Vec<f64> {
    let mut sum = vec![0.0; signals.points.len()];
    let mut first = 0;
    for term in terms {
        let count = term.effect.columns();
        if which(&term.effect) {
            for (k, column) in columns::working(signals, &term.effect, &term.shape)
                .iter()
                .enumerate()
            {
                let c = coefficients.get(first + k).copied().unwrap_or(0.0);
                sum.iter_mut().zip(column).for_each(|(s, x)| *s += c * x);
            }
        }
        first += count;
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

fn gather(dataset: &Dataset, spec: &ModelSpec, sessions: &[Signals], filters: &Filters) -> Facts {
    let mut positions = Vec::new();
    let mut speeds = Vec::new();
    let mut torques = Vec::new();
    for signals in sessions {
        for &at in &signals.rows {
            let point = &signals.points[at];
            positions.push(point.position);
            speeds.push(point.velocity.abs());
            torques.push(point.motor_torque.abs());
        }
    }
    let temperatures: Vec<f64> = dataset
        .sessions
        .iter()
        .filter_map(|s| s.temperature.as_ref())
        .flat_map(|t| t.iter().step_by(10).copied())
        .collect();
    let span = |values: &[f64]| {
        let (low, high) = values
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| {
                (l.min(*x), h.max(*x))
            });
        if low <= high { high - low } else { 0.0 }
    };
    let starts: Vec<f64> = dataset
        .sessions
        .iter()
        .map(|s| s.start / 86_400.0)
        .collect();
    Facts {
        joint: dataset.joint,
        inertia: match spec.inertia {
            Inertia::Given(inertia) => Some(inertia),
            Inertia::Fit => None,
        },
        gear_ratio: spec.gear_ratio,
        joint_torque: dataset.sessions.iter().all(|s| s.joint_torque.is_some()),
        temperature: dataset.sessions.iter().all(|s| s.temperature.is_some()),
        reference_temperature: temperatures.iter().sum::<f64>() / temperatures.len().max(1) as f64,
        temperature_range: span(&temperatures),
        sessions: dataset.sessions.len(),
        days: span(&starts),
        position: [
            quantile(&mut positions, 0.02),
            quantile(&mut positions, 0.98),
        ],
        speed: [quantile(&mut speeds, 0.02), quantile(&mut speeds, 0.98)],
        motor_torque: quantile(&mut torques, 0.999),
        resolved: RESOLVED * filters.position_noise,
        loaded: dataset.joint.is_contact()
            || dataset.sessions.iter().all(|s| s.joint_torque.is_some())
            || spec.inertia != Inertia::Given(0.0)
            || spec
                .effects
                .iter()
                .any(|t| ["gravity", "cable_spring"].contains(&t.name())),
        period: sessions
            .first()
            .map_or(filters.thinning as f64, |s| s.period),
        load_coulomb: spec
            .effects
            .iter()
            .any(|t| effects::is_load_coulomb(t.name())),
    }
}
