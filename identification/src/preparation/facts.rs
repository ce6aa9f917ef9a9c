//! Properties of recordings and model that the effects depend on.

use crate::data::{Dataset, Inertia, ModelSpec, Term};
use crate::effects::expression::is_load;
use crate::effects::{self, Facts, Row};
use crate::numerics::statistics::quantile_or_zero;
use crate::signals::{Filters, RESOLVED, Signals};

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

/// Gathers them: ranges of the signals over the rows of `sessions`, and what
/// `dataset` and `spec` state.
pub(super) fn gather(
    dataset: &Dataset,
    spec: &ModelSpec,
    sessions: &[Signals],
    filters: &Filters,
) -> Facts {
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
        torque_is_modelled: (dataset.sessions.iter())
            .any(|s| s.torque_is_modelled || s.torque_is_of_links),
        torque_is_of_links: dataset.sessions.iter().any(|s| s.torque_is_of_links),
        temperature: dataset.sessions.iter().all(|s| s.temperature.is_some()),
        reference_temperature: temperatures.iter().sum::<f64>() / temperatures.len().max(1) as f64,
        temperature_range: span(&temperatures),
        sessions: dataset.sessions.len(),
        days: span(&starts),
        position: [
            quantile_or_zero(&mut positions, 0.02),
            quantile_or_zero(&mut positions, 0.98),
        ],
        speed: [
            quantile_or_zero(&mut speeds, 0.02),
            quantile_or_zero(&mut speeds, 0.98),
        ],
        motor_torque: quantile_or_zero(&mut torques, 0.999),
        common_torque: quantile_or_zero(&mut torques, 0.75),
        resolved: RESOLVED * filters.position_noise,
        loaded: dataset.joint.is_contact()
            || dataset.sessions.iter().all(|s| s.joint_torque.is_some())
            || spec.inertia != Inertia::Given(0.0)
            || has_row(spec, |row| row.is_load)
            || has_formula_of_load(dataset, spec),
        period: sessions
            .first()
            .map_or(filters.thinning as f64, |s| s.period),
        load_coulomb: has_row(spec, Row::is_load_coulomb),
    }
}
