//! Properties of recordings and model that the effects depend on.

use crate::data::{Dataset, Inertia, ModelSpec, Term};
use crate::effects::expression::is_load;
use crate::effects::{self, Facts, Row};
use crate::numerics::statistics::quantile_or_zero;
use crate::signals::{Filters, RESOLVED, Signals};

/// Standard deviation of the temperature within sessions, in steps that it is read in, from
/// which on these tell how the torque changes with it: rounding adds 2 % to its variance.
const RESOLVED_STEPS: f64 = 2.0;

/// Whether a model has an effect of the catalogue whose row satisfies `is`.
fn has_row(spec: &ModelSpec, is: impl Fn(&Row) -> bool) -> bool {
    let ids = spec.effects.iter().map(Term::name);
    ids.filter_map(effects::find).any(|effect| is(effect.row()))
}

/// Whether a formula of the model is a load.
fn has_formula_of_load(dataset: &Dataset, spec: &ModelSpec) -> bool {
    let first = dataset.sessions.first();
    let extras: Vec<String> = first.map_or_else(Vec::new, |s| s.extra.keys().cloned().collect());
    let subject = dataset.joint.subject();
    spec.effects.iter().any(|term| match term {
        Term::Custom(custom) => is_load(custom, subject, &extras),
        Term::Catalogue(_) => false,
    })
}

/// Ranges of the signals, which are the same whatever the model.
pub(super) struct Ranges {
    /// Whether every session has a temperature.
    pub(super) temperature: bool,
    /// Mean temperature \[degC\].
    pub(super) reference_temperature: f64,
    temperature_range: f64,
    /// Whether it varies within sessions by more than the steps that it is read in.
    pub(super) temperature_is_resolved: bool,
    days: f64,
    recording_length: f64,
    position: [f64; 2],
    speed: [f64; 2],
    motor_torque: f64,
    friction_power: f64,
    common_torque: f64,
}

impl Ranges {
    /// Over the rows of `sessions`, those of `dataset` made ready.
    pub(super) fn new(dataset: &Dataset, sessions: &[Signals]) -> Self {
        let mut positions = Vec::new();
        let mut speeds = Vec::new();
        let mut torques = Vec::new();
        let mut power = 0.0;
        for signals in sessions {
            for &at in &signals.rows {
                let point = &signals.points[at];
                positions.push(point.position);
                speeds.push(point.velocity.abs());
                torques.push(point.motor_torque.abs());
                power += point.friction_power();
            }
        }
        let temperatures: Vec<f64> = dataset
            .sessions
            .iter()
            .filter_map(|s| s.temperature.as_ref())
            .flat_map(|t| t.iter().step_by(10).copied())
            .collect();
        let starts: Vec<f64> = dataset
            .sessions
            .iter()
            .map(|s| s.start / 86_400.0)
            .collect();
        let ends = (dataset.sessions.iter()).map(|s| s.into_recording + s.len() as f64 * s.period);
        let recording_length = ends.fold(0.0, f64::max);
        Self {
            temperature: dataset.sessions.iter().all(|s| s.temperature.is_some()),
            reference_temperature: temperatures.iter().sum::<f64>()
                / temperatures.len().max(1) as f64,
            temperature_range: span(&temperatures),
            temperature_is_resolved: is_resolved(dataset),
            days: span(&starts),
            recording_length,
            position: [
                quantile_or_zero(&mut positions, 0.02),
                quantile_or_zero(&mut positions, 0.98),
            ],
            speed: [
                quantile_or_zero(&mut speeds, 0.02),
                quantile_or_zero(&mut speeds, 0.98),
            ],
            motor_torque: quantile_or_zero(&mut torques, 0.999),
            friction_power: power / torques.len().max(1) as f64,
            common_torque: quantile_or_zero(&mut torques, 0.75),
        }
    }
}

/// Whether the temperature varies within sessions by more than the steps that it is read in.
fn is_resolved(dataset: &Dataset) -> bool {
    let sessions = dataset.sessions.iter();
    let (mut step, mut squares, mut count) = (f64::INFINITY, 0.0, 0);
    for own in sessions.filter_map(|session| session.temperature.as_deref()) {
        let mean = own.iter().sum::<f64>() / own.len().max(1) as f64;
        squares += own.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
        count += own.len();
        let steps = own.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        step = steps.filter(|step| *step > 0.0).fold(step, f64::min);
    }
    let deviation = (squares / count.max(1) as f64).sqrt();
    deviation > RESOLVED_STEPS * step
}

/// Largest less least value; 0 of none.
fn span(values: &[f64]) -> f64 {
    let (low, high) = values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| {
            (l.min(*x), h.max(*x))
        });
    if low <= high { high - low } else { 0.0 }
}

/// Gathers them: `ranges` of the signals, and what `dataset` and `spec` state.
pub(super) fn gather(
    dataset: &Dataset,
    spec: &ModelSpec,
    ranges: &Ranges,
    filters: &Filters,
) -> Facts {
    Facts {
        joint: dataset.joint,
        inertia: match spec.inertia {
            Inertia::Given(inertia) => Some(inertia),
            Inertia::Fit => None,
        },
        gear_ratio: spec.gear_ratio,
        joint_torque: dataset.sessions.iter().all(|s| s.joint_torque.is_some()),
        torque_is_modelled: (dataset.sessions.iter())
            .any(|s| s.torque_is_modelled || s.torque_is_of_links),
        torque_is_of_links: dataset.sessions.iter().any(|s| s.torque_is_of_links),
        temperature: ranges.temperature,
        reference_temperature: ranges.reference_temperature,
        temperature_range: ranges.temperature_range,
        sessions: dataset.sessions.len(),
        days: ranges.days,
        recording_length: ranges.recording_length,
        position: ranges.position,
        speed: ranges.speed,
        motor_torque: ranges.motor_torque,
        friction_power: ranges.friction_power,
        common_torque: ranges.common_torque,
        resolved: RESOLVED * filters.position_noise,
        loaded: dataset.joint.is_contact()
            || dataset.sessions.iter().all(|s| s.joint_torque.is_some())
            || spec.inertia != Inertia::Given(0.0)
            || has_row(spec, |row| row.is_load)
            || has_formula_of_load(dataset, spec),
        period: (dataset.sessions.first())
            .map_or(1.0, |s| s.period * filters.thinning(s.period) as f64),
        load_coulomb: has_row(spec, Row::is_load_coulomb),
    }
}
