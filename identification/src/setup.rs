//! Recordings and model put together: signals ready, effects bound, facts known.

use std::sync::Arc;

use nalgebra::DVector;

use crate::check::check;
use crate::data::{Dataset, Inertia, ModelSpec, Term};
use crate::design::Design;
use crate::effects::{self, EffectHandle, Facts, Part, Row, with_columns};
use crate::error::PrepareError;
use crate::expression::Compiled;
use crate::filter::Kernel;
use crate::refine;
use crate::signals::{Filters, RESOLVED, Signals, quantile};

/// Rounds over the shapes of a model's effects, at most, …
const MAX_ROUNDS: usize = 8;
/// … and none after one that moves no shape by this share.
const SETTLED: f64 = 0.002;

/// An effect of the model with the shape it has.
#[derive(Clone)]
pub struct BoundTerm {
    /// The effect.
    pub effect: EffectHandle,
    /// Its shape parameters.
    pub shape: Vec<f64>,
    /// Coefficients with which it has been taken out of the channels; empty for
    /// an effect that acts on torque.
    pub undone: Vec<f64>,
}

impl BoundTerm {
    /// An effect with a shape.
    #[must_use]
    pub fn new(effect: EffectHandle, shape: Vec<f64>) -> Self {
        Self {
            effect,
            shape,
            undone: Vec::new(),
        }
    }
}

/// Everything that fits and tests start from.
#[derive(Clone)]
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
    /// Whether rows near rest and just after reversals count.
    pub reversals: bool,
    /// Coefficients of the effects that need no prediction, by which all others'
    /// prediction is made.
    pub(crate) predicted: DVector<f64>,
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
            reversals: false,
            predicted: DVector::zeros(0),
        };
        setup.terms = setup.bind(spec)?;
        if setup.terms.iter().any(|t| t.effect.row().shows_at_turns) {
            setup.keep_reversals();
        }
        let parameters = setup.terms.iter().map(|t| t.effect.columns()).sum();
        let rows = setup.sessions.iter().map(|s| s.rows.len()).sum();
        if rows < 20 + 5 * parameters {
            return Err(PrepareError::NothingExcited { rows, parameters });
        }
        setup.model_load();
        setup.find_shapes();
        setup.model_load();
        setup.predict();
        setup.undo();
        setup.find_shapes_between_breaks();
        Ok(setup)
    }

    fn bind(&self, spec: &ModelSpec) -> Result<Vec<BoundTerm>, PrepareError> {
        let mut terms: Vec<BoundTerm> = Vec::new();
        if spec.inertia == Inertia::Fit {
            let inertia = Arc::new(effects::Inertia::fitted());
            terms.push(BoundTerm::new(inertia, Vec::new()));
        }
        for term in &spec.effects {
            let effect = self.resolve(term)?;
            let id = &effect.description().id;
            if let Some(why) = effect.unavailable(&self.facts) {
                return Err(PrepareError::Unavailable {
                    id: id.clone(),
                    why,
                });
            }
            if terms.iter().any(|t| &t.effect.description().id == id) {
                return Err(PrepareError::Twice(id.clone()));
            }
            // A start for the search: the middle of the grid, else of the bounds.
            let shapes = effect.shapes(&self.facts);
            let bounds = effect.bounds(&self.facts);
            let shape = match shapes.get(shapes.len() / 2) {
                Some(shape) if !shape.is_empty() || bounds.is_empty() => shape.clone(),
                _ => bounds.iter().map(|b| 0.5 * (b[0] + b[1])).collect(),
            };
            terms.push(BoundTerm::new(effect, shape));
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

    /// The model's effect `id`, and the place of its first column.
    #[must_use]
    pub fn first_column(&self, id: &str) -> Option<(&BoundTerm, usize)> {
        let mut terms = with_columns(&self.terms);
        let (term, columns) = terms.find(|(t, _)| t.effect.description().id == id)?;
        Some((term, columns.start))
    }

    /// First coefficient of the model's effect that is this part of friction,
    /// fitted to everything; 0 where the model does not have it.
    #[must_use]
    pub fn coefficient(&self, part: Part) -> f64 {
        let mut terms = with_columns(&self.terms);
        let own = terms.find(|(term, _)| term.effect.row().part == Some(part));
        own.and_then(|(_, columns)| Design::new(self).shared.get(columns.start).copied())
            .unwrap_or(0.0)
    }

    /// The same with the rows near rest and just after reversals; of a contact
    /// only while it lasts.
    #[must_use]
    pub fn with_reversals(&self) -> Self {
        let mut whole = self.clone();
        whole.keep_reversals();
        whole
    }

    pub(crate) fn keep_reversals(&mut self) {
        self.reversals = true;
        for signals in self.sessions.iter_mut().chain(&mut self.held_out) {
            signals.rows.clone_from(&signals.turning_rows);
        }
    }

    /// Leaves rows with breaks out, and finds the shapes of the effects that break
    /// there again: a break says little of these, and much that is wrong.
    fn find_shapes_between_breaks(&mut self) {
        let all: Vec<Vec<usize>> = self.rows().map(<[usize]>::to_vec).collect();
        self.leave_out_breaks();
        if self.rows().eq(all.iter().map(Vec::as_slice)) {
            return;
        }
        for at in 0..self.terms.len() {
            let mut term = self.terms.remove(at);
            let mut sessions = self.sessions.iter();
            if sessions.any(|s| !term.effect.breaks(&term.shape, &s.points).is_empty()) {
                let design = Design::new(self);
                term.shape = refine::polish(self, &design, &term.effect, &term.shape);
            }
            self.terms.insert(at, term);
        }
        let sessions = self.sessions.iter_mut().chain(&mut self.held_out);
        for (signals, rows) in sessions.zip(all) {
            signals.rows = rows;
        }
        self.predict();
        self.leave_out_breaks();
    }

    /// Leaves out the rows that reach to where an effect of the model breaks.
    pub(crate) fn leave_out_breaks(&mut self) {
        let reach = Kernel::reach(self.filters.column);
        for signals in self.sessions.iter_mut().chain(&mut self.held_out) {
            for term in &self.terms {
                let breaks = term.effect.breaks(&term.shape, &signals.points);
                signals.rows.retain(|row| {
                    let after = breaks.partition_point(|at| at + reach < *row);
                    breaks.get(after).is_none_or(|at| *at > row + reach)
                });
            }
        }
    }

    /// Rows of each session.
    pub fn rows(&self) -> impl Iterator<Item = &[usize]> {
        let all = self.sessions.iter().chain(&self.held_out);
        all.map(|signals| signals.rows.as_slice())
    }

    /// The same with the rows of `other`.
    #[must_use]
    pub fn on_rows_of(mut self, other: &Self) -> Self {
        let own = self.sessions.iter_mut().chain(&mut self.held_out);
        let theirs = other.sessions.iter().chain(&other.held_out);
        for (own, theirs) in own.zip(theirs) {
            own.rows.clone_from(&theirs.rows);
        }
        self
    }

    /// Finds the shape of the model's own effects, one after the other: one depends
    /// on the others', and on what they predict. First anywhere, then close to
    /// where it is, until nothing moves.
    fn find_shapes(&mut self) {
        let searched: Vec<usize> = (0..self.terms.len())
            .filter(|i| !self.terms[*i].shape.is_empty())
            .collect();
        let predicts = self.terms.iter().any(|t| t.effect.row().needs_prediction);
        let most = match (predicts, searched.len()) {
            (true, _) => MAX_ROUNDS,
            (false, 0 | 1) => 1,
            (false, _) => 2,
        };
        for round in 0..most {
            let mut moved = 0.0;
            for &at in &searched {
                if self.terms[at].effect.row().needs_prediction {
                    self.predict();
                }
                let mut term = self.terms.remove(at);
                let design = Design::new(self);
                let shape = match round {
                    0 | 1 => refine::search(self, &design, &term.effect),
                    _ => Some(refine::polish(self, &design, &term.effect, &term.shape)),
                };
                let shape = shape.unwrap_or_else(|| term.shape.clone());
                moved = f64::max(moved, farthest(&term.shape, &shape));
                term.shape = shape;
                self.terms.insert(at, term);
            }
            if round > 0 && moved < SETTLED {
                break;
            }
        }
    }
}

/// The most by which a parameter of a shape changes, as a share of it.
fn farthest(before: &[f64], after: &[f64]) -> f64 {
    let both = before.iter().zip(after);
    both.map(|(before, after)| (after - before).abs() / before.abs().max(1e-300))
        .fold(0.0, f64::max)
}

/// Whether a model has an effect of the catalogue whose row is like this.
fn has_row(spec: &ModelSpec, is: impl Fn(&Row) -> bool) -> bool {
    let ids = spec.effects.iter().map(Term::name);
    ids.filter_map(effects::find).any(|effect| is(effect.row()))
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
            || has_row(spec, |row| row.is_load),
        period: sessions
            .first()
            .map_or(filters.thinning as f64, |s| s.period),
        load_coulomb: has_row(spec, Row::is_load_coulomb),
    }
}
