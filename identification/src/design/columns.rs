//! Columns of an effect on a session.

use std::sync::Arc;

use ferntast_model::friction::FrictionState;

use crate::effects::{
    BoundTerm, EffectHandle, Exact, ExactSignal, MAX_COLUMNS, constant_of, parts_of,
};
use crate::numerics::filter::Kernel;
use crate::signals::{Columns, Filters, Key, Point, Signals};

/// Columns of an effect at the working rate, not filtered; in the unit of the torque
/// over that of the coefficient.
#[must_use]
pub fn working(signals: &Signals, effect: &EffectHandle, shape: &[f64]) -> Vec<Vec<f64>> {
    let whole = match effect.is_of_motion() {
        true => {
            let points = || signals.points.iter().map(Point::friction_state).collect();
            effect.of_states(shape, &signals.kept.states(points))
        }
        false => effect
            .whole(shape, &signals.points)
            .or_else(|| of_points(effect, shape, &signals.points, Point::friction_state)),
    };
    whole.unwrap_or_else(|| evaluated(signals, effect, shape, signals.points.iter()))
}

/// Points whose states are at hand at a time.
const POINTS_AT_ONCE: usize = 1024;

/// Columns of an effect that is a function of the states alone, `state` at each point.
fn of_points(
    effect: &EffectHandle,
    shape: &[f64],
    points: &[Point],
    state: impl Fn(&Point) -> FrictionState,
) -> Option<Vec<Vec<f64>>> {
    let mut columns = effect.of_states(shape, &[])?;
    for column in &mut columns {
        column.reserve_exact(points.len());
    }
    for some in points.chunks(POINTS_AT_ONCE) {
        let states: Vec<FrictionState> = some.iter().map(&state).collect();
        let each = columns.iter_mut().zip(effect.of_states(shape, &states)?);
        each.for_each(|(column, next)| column.extend(next));
    }
    Some(columns)
}

/// The same of a term of a model, kept where it is of the motion alone.
#[must_use]
pub fn kept(signals: &Signals, effect: &EffectHandle, shape: &[f64]) -> Columns {
    match effect.is_of_motion() {
        true => {
            let key = Key::new(&effect.description().id, shape, 0.0);
            // Asked once, so that no states are kept for it.
            let states = || of_points(effect, shape, &signals.points, Point::friction_state);
            (signals.kept).working(key, || {
                states().unwrap_or_else(|| working(signals, effect, shape))
            })
        }
        false => Arc::new(working(signals, effect, shape)),
    }
}

/// A velocity at each point in place of the measured one, by a step \[rad/s\].
#[derive(Clone, Copy, Debug)]
pub enum OtherVelocity {
    /// Faster by the step.
    Faster(f64),
    /// The step alone.
    AboveRest(f64),
}

impl OtherVelocity {
    fn at(self, point: &Point) -> f64 {
        match self {
            Self::Faster(step) => point.velocity + step * point.sign(),
            Self::AboveRest(step) => step * point.sign(),
        }
    }

    /// What its columns are kept by.
    fn key(self, effect: &EffectHandle, shape: &[f64]) -> Key {
        let id = &effect.description().id;
        match self {
            Self::Faster(step) => Key::new(&format!("{id}, faster"), shape, step),
            Self::AboveRest(step) => Key::new(&format!("{id}, above rest"), shape, step),
        }
    }
}

/// The same with another `velocity` at each point.
#[must_use]
pub fn at_velocity(
    signals: &Signals,
    effect: &EffectHandle,
    shape: &[f64],
    velocity: OtherVelocity,
) -> Columns {
    if !effect.reads_velocity() {
        return kept(signals, effect, shape);
    }
    let make = || {
        let state = |point: &Point| FrictionState {
            velocity: velocity.at(point),
            ..point.friction_state()
        };
        if let Some(columns) = of_points(effect, shape, &signals.points, state) {
            return columns;
        }
        let changed = |point: &Point| Point {
            velocity: velocity.at(point),
            ..*point
        };
        let points: Vec<Point> = signals.points.iter().map(changed).collect();
        let whole = match effect.is_of_motion() {
            true => None,
            false => effect.whole(shape, &points),
        };
        whole.unwrap_or_else(|| evaluated(signals, effect, shape, points.iter()))
    };
    match effect.is_of_motion() {
        true => (signals.kept).working(velocity.key(effect, shape), make),
        false => Arc::new(make()),
    }
}

/// Columns of an effect that goes through `points` one by one, with the session's extra signals.
fn evaluated<'a>(
    signals: &Signals,
    effect: &EffectHandle,
    shape: &[f64],
    points: impl Iterator<Item = &'a Point>,
) -> Vec<Vec<f64>> {
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
    for (at, point) in points.enumerate() {
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
    let mut columns: Vec<Vec<f64>> = exact.iter().map(column).collect();
    // Further columns are no channels.
    if columns.len() < effect.columns() {
        let others = working(signals, effect, shape);
        let others = others.iter().skip(columns.len());
        columns.extend(others.map(|column| signals.column.at_samples(column, rows)));
    }
    columns
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
) -> Columns {
    let (effect, shape) = (&term.effect, &term.shape);
    if term.compensated.is_empty() {
        let make = || filtered(signals, filters, inertia, effect, shape, rows);
        if !effect.is_of_motion() {
            return Arc::new(make());
        }
        let key = Key::new(&effect.description().id, shape, inertia);
        return signals.kept.filtered(rows, key, make);
    }
    Arc::new(match signals.jacobians.get(&effect.description().id) {
        Some(columns) => (columns.iter())
            .map(|column| signals.column.at_samples(column, rows))
            .collect(),
        None => vec![vec![0.0; rows.len()]; effect.columns()],
    })
}

/// y = τ_m − τ − J q̈ \[Nm\] at the working samples `rows`, through the column filter.
#[must_use]
pub fn measured(signals: &Signals, filters: &Filters, inertia: f64, rows: &[usize]) -> Vec<f64> {
    let key = Key::new("", &[], inertia);
    let make = || vec![filtered_balance(signals, filters, inertia, rows)];
    let kept = signals.kept.filtered(rows, key, make);
    kept.first().cloned().unwrap_or_default()
}

fn filtered_balance(
    signals: &Signals,
    filters: &Filters,
    inertia: f64,
    rows: &[usize],
) -> Vec<f64> {
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
