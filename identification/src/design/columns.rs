//! Columns of an effect on a session.

use crate::effects::{
    BoundTerm, EffectHandle, Exact, ExactSignal, MAX_COLUMNS, constant_of, parts_of,
};
use crate::numerics::filter::Kernel;
use crate::signals::{Filters, Signals};

/// Columns of an effect at the working rate, not filtered; in the unit of the torque
/// over that of the coefficient.
#[must_use]
pub fn working(signals: &Signals, effect: &EffectHandle, shape: &[f64]) -> Vec<Vec<f64>> {
    if let Some(columns) = effect.whole(shape, &signals.points) {
        return columns;
    }
    let count = effect.columns().min(MAX_COLUMNS);
    let mut columns = vec![Vec::with_capacity(signals.points.len()); count];
    let extras: Vec<&[f64]> = effect
        .extra()
        .iter()
        .map(|name| signals.extra.get(name).map_or(&[][..], Vec::as_slice))
        .collect();
    let mut memory = [0.0; 4];
    let mut values = [0.0; MAX_COLUMNS];
    let mut extra = vec![0.0; extras.len()];
    for (at, point) in signals.points.iter().enumerate() {
        for (value, signal) in extra.iter_mut().zip(&extras) {
            *value = signal.get(at).copied().unwrap_or(0.0);
        }
        effect.evaluate_with(shape, point, &extra, &mut memory, &mut values[..count]);
        for (column, value) in columns.iter_mut().zip(&values) {
            column.push(*value);
        }
    }
    columns
}

/// Columns of an effect at the working samples `rows`, through the column filter.
#[must_use]
pub fn filtered(
    signals: &Signals,
    filters: &Filters,
    inertia: f64,
    effect: &EffectHandle,
    shape: &[f64],
    rows: &[usize],
) -> Vec<Vec<f64>> {
    let kernel = |order| Kernel::gaussian(filters.column, order, signals.period);
    let exact = effect.row().exact;
    if exact.is_empty() || filters.stated.is_some() {
        let smooth = &signals.column;
        return working(signals, effect, shape)
            .iter()
            .map(|column| smooth.at_samples(column, rows))
            .collect();
    }
    let column = |channel: &Exact| {
        let mut sum = vec![constant_of(*channel); rows.len()];
        for (signal, order, factor) in parts_of(*channel, inertia) {
            let signal = match signal {
                ExactSignal::Position => &signals.raw.position,
                ExactSignal::JointTorque => &signals.raw.joint_torque,
            };
            let filtered = kernel(order).at_samples(signal, rows);
            sum.iter_mut()
                .zip(filtered)
                .for_each(|(sum, value)| *sum += factor * value);
        }
        sum
    };
    exact.iter().map(column).collect()
}

/// Columns of a term of the model at the working samples `rows`, through the column
/// filter.
#[must_use]
pub fn filtered_term(
    signals: &Signals,
    filters: &Filters,
    inertia: f64,
    term: &BoundTerm,
    rows: &[usize],
) -> Vec<Vec<f64>> {
    if term.compensated.is_empty() {
        return filtered(signals, filters, inertia, &term.effect, &term.shape, rows);
    }
    match signals.jacobians.get(&term.effect.description().id) {
        Some(columns) => (columns.iter())
            .map(|column| signals.column.at_samples(column, rows))
            .collect(),
        None => vec![vec![0.0; rows.len()]; term.effect.columns()],
    }
}

/// y = τ_m − τ − J q̈ \[Nm\] at the working samples `rows`, through the column filter.
#[must_use]
pub fn measured(signals: &Signals, filters: &Filters, inertia: f64, rows: &[usize]) -> Vec<f64> {
    let smooth = &signals.column;
    let torque = smooth.at_samples(&signals.raw.motor_torque, rows);
    let load = smooth.at_samples(&signals.raw.joint_torque, rows);
    let acceleration = match filters.stated {
        Some(_) => {
            let all: Vec<f64> = signals.points.iter().map(|p| p.acceleration).collect();
            smooth.at_samples(&all, rows)
        }
        None => Kernel::gaussian(filters.column, 2, signals.period)
            .at_samples(&signals.raw.position, rows),
    };
    torque
        .iter()
        .zip(load)
        .zip(acceleration)
        .map(|((m, l), a)| m - l - inertia * a)
        .collect()
}
