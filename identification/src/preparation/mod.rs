//! Recordings and model put together: signals filtered, effects bound and their
//! shapes searched, the model's prediction made, channels compensated.

mod binding;
mod compensation;
mod facts;
mod prediction;
mod shapes;

use std::sync::Arc;

use nalgebra::DVector;

use crate::data::check::check;
use crate::data::error::PrepareError;
use crate::data::{Dataset, ModelSpec, RecordedSession};
use crate::design::PreparedModel;
use crate::effects::BoundTerm;
use crate::signals::{Filters, Signals};

use facts::Ranges;

/// Recordings filtered, to which any model can be bound: filters go by the noise
/// in the recordings alone.
pub(crate) struct Filtered<'a> {
    dataset: &'a Dataset,
    filters: Filters,
    sessions: Vec<Signals>,
    held_out: Vec<Signals>,
    ranges: Ranges,
}

/// A shape that has been found already: none is searched.
#[derive(Clone, Copy, Debug)]
pub(crate) struct KnownShape<'a> {
    /// Id of the effect.
    pub effect: &'a str,
    pub shape: &'a [f64],
}

/// Binds the model `spec` to the recordings in `dataset`.
///
/// # Errors
///
/// See [`PrepareError`].
pub fn prepare(dataset: &Dataset, spec: &ModelSpec) -> Result<PreparedModel, PrepareError> {
    check(dataset, spec)?;
    Filtered::new(dataset).bind(spec)
}

impl<'a> Filtered<'a> {
    /// Filters recordings that have been checked.
    pub(crate) fn new(dataset: &'a Dataset) -> Self {
        Self::at_cut_off(dataset, 1.0)
    }

    /// The same, with filters at `factor` times the cut-off.
    pub(crate) fn at_cut_off(dataset: &'a Dataset, factor: f64) -> Self {
        let filters = Filters::at_cut_off(dataset, factor);
        let filtered = |sessions: &[RecordedSession]| -> Vec<Signals> {
            let sessions = sessions.iter();
            sessions.map(|s| Signals::new(s, &filters)).collect()
        };
        let mut sessions = filtered(&dataset.sessions);
        let mut held_out = filtered(&dataset.held_out);
        let ranges = Ranges::new(dataset, &sessions);
        if ranges.temperature {
            for signals in sessions.iter_mut().chain(&mut held_out) {
                for point in Arc::make_mut(&mut signals.points) {
                    point.temperature -= ranges.reference_temperature;
                }
            }
        }
        Self {
            dataset,
            filters,
            sessions,
            held_out,
            ranges,
        }
    }

    /// The same recordings with filters at `factor` times the cut-off.
    pub(crate) fn at_factor(&self, factor: f64) -> Self {
        Self::at_cut_off(self.dataset, factor)
    }

    /// Whether they are of a contact.
    pub(crate) fn is_contact(&self) -> bool {
        self.dataset.joint.is_contact()
    }

    /// Binds a model whose numbers have been checked.
    pub(crate) fn bind(&self, spec: &ModelSpec) -> Result<PreparedModel, PrepareError> {
        self.bind_for(spec, true, None)
    }

    /// The same, to be fitted and no more: where no term needs the model's own prediction,
    /// none is made, nor is the load modelled where no term depends on it; no effect that needs
    /// either can be tried.
    pub(crate) fn bind_to_fit(
        &self,
        spec: &ModelSpec,
        known: Option<KnownShape<'_>>,
    ) -> Result<PreparedModel, PrepareError> {
        self.bind_for(spec, false, known)
    }

    fn bind_for(
        &self,
        spec: &ModelSpec,
        predict: bool,
        known: Option<KnownShape<'_>>,
    ) -> Result<PreparedModel, PrepareError> {
        let mut prepared = self.without_terms(spec);
        prepared.terms = prepared.bind(spec)?;
        if let Some(known) = known {
            let mut own = prepared.terms.iter_mut();
            if let Some(term) = own.find(|t| t.effect.description().id == known.effect) {
                term.shape = known.shape.to_vec();
            }
        }
        let mut terms = prepared.terms.iter();
        if terms.any(|t| t.effect.row().shows_at_reversals) {
            prepared.keep_reversals();
        }
        check_excited(&prepared)?;
        // Shapes are not searched by a load on which no term depends.
        let of_motion = prepared.is_of_motion();
        if !of_motion {
            prepared.model_load();
        }
        prepared.find_shapes(known.map(|own| own.effect));
        if predict || !of_motion {
            prepared.model_load();
        }
        let mut terms = prepared.terms.iter();
        if predict || terms.any(|term| term.effect.row().needs_prediction) {
            prepared.predict();
        }
        // What is compensated reads neither load nor prediction.
        let is_compensated = |term: &BoundTerm| term.effect.row().acts_on_channels;
        let mut others = prepared.terms.iter().filter(|term| !is_compensated(term));
        let is_read = predict || others.any(|term| !term.effect.is_of_motion());
        prepared.compensate(is_read);
        prepared.refine_shapes_on_determined_rows();
        check_excited(&prepared)?;
        Ok(prepared)
    }

    /// Signals and facts, without any term yet.
    fn without_terms(&self, spec: &ModelSpec) -> PreparedModel {
        PreparedModel {
            facts: facts::gather(self.dataset, spec, &self.ranges, &self.filters),
            temperature_is_resolved: self.ranges.temperature_is_resolved,
            filters: self.filters,
            sessions: self.sessions.clone(),
            held_out: self.held_out.clone(),
            terms: Vec::new(),
            reversals: false,
            predicted: DVector::zeros(0),
        }
    }
}

/// Whether there are rows enough to fit the model to.
fn check_excited(prepared: &PreparedModel) -> Result<(), PrepareError> {
    let parameters = prepared.terms.iter().map(|t| t.effect.columns()).sum();
    let rows = prepared.sessions.iter().map(|s| s.rows.len()).sum();
    match rows < 20 + 5 * parameters {
        true => {
            let filters = &prepared.filters;
            let period = filters.working_period;
            Err(PrepareError::NothingExcited {
                rows,
                parameters,
                rate_hz: period.recip(),
                cut_off_hz: filters.cut_off(period),
                reach_s: filters.reach(period),
            })
        }
        false => Ok(()),
    }
}

/// `prepared` with one more effect in the model, whose shape is kept.
#[must_use]
pub fn extend(prepared: &PreparedModel, term: BoundTerm) -> PreparedModel {
    let acts_on_channels = term.effect.row().acts_on_channels;
    let mut extended = prepared.clone();
    extended.facts.load_coulomb |= term.effect.row().is_load_coulomb();
    extended.terms.push(term);
    extended.predict();
    if acts_on_channels {
        extended.compensate(true);
    }
    extended.leave_out_undetermined_rows();
    extended
}
