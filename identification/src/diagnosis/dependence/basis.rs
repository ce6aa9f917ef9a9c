//! Signals at the rows of the regression, and piecewise linear columns over them.

use crate::design::PreparedModel;
use crate::effects::Direction;
use crate::numerics::statistics::quantile_or_zero;

/// Knots of a map over one signal, …
const KNOTS_ALONE: usize = 7;
/// … and of each signal of a map over two.
pub(super) const KNOTS_PAIR: usize = 4;
/// The same where the sessions' paths through the plane of two joints have little in
/// common: one slope over each signal, and their product.
pub(super) const KNOTS_PRODUCT: usize = 2;

/// A signal at the rows of every session.
pub(super) struct Channel {
    pub(super) name: String,
    pub(super) values: Vec<Vec<f64>>,
    /// Whether it hardly varies within a session (temperature, date).
    pub(super) slow: bool,
}

/// Every signal on which the residual may depend.
pub(super) fn channels(prepared: &PreparedModel) -> Vec<Channel> {
    let facts = &prepared.facts;
    let collect =
        |name: &str, slow: bool, value: &dyn Fn(&crate::signals::Signals, usize) -> f64| Channel {
            name: facts.joint.signal(name).to_owned(),
            slow,
            values: prepared
                .sessions
                .iter()
                .map(|s| s.rows.iter().map(|at| value(s, *at)).collect())
                .collect(),
        };
    let mut all = vec![
        collect("position", false, &|s, at| s.points[at].position),
        collect("velocity", false, &|s, at| s.points[at].velocity.abs()),
        collect("acceleration", false, &|s, at| s.points[at].acceleration),
        collect("time", false, &|s, at| s.time(at)),
    ];
    if facts.loaded {
        all.push(collect("load", false, &|s, at| s.points[at].load));
        all.push(collect("load_rate", false, &|s, at| s.points[at].load_rate));
    }
    if facts.temperature && facts.temperature_range > 2.0 && facts.sessions >= 4 {
        all.push(collect("temperature", true, &|s, at| {
            s.points[at].temperature
        }));
    }
    if facts.days > 0.5 && facts.sessions >= 4 {
        all.push(collect("date", true, &|s, at| s.points[at].days));
    }
    let names: Vec<String> = prepared
        .sessions
        .first()
        .map(|s| s.extra.keys().cloned().collect())
        .unwrap_or_default();
    for name in names {
        all.push(collect(&name, false, &|s, at| {
            s.extra
                .get(&name)
                .and_then(|x| x.get(at))
                .copied()
                .unwrap_or(0.0)
        }));
    }
    all
}

/// Knots of the hat functions over one signal, at its quantiles.
fn knots(channel: &Channel, count: usize) -> Vec<f64> {
    let mut all: Vec<f64> = channel
        .values
        .iter()
        .flatten()
        .step_by(3)
        .copied()
        .collect();
    let low = quantile_or_zero(&mut all, 0.01);
    let high = quantile_or_zero(&mut all, 0.99);
    let mut knots: Vec<f64> = (0..count)
        .map(|i| {
            let share = i as f64 / (count - 1) as f64;
            // Halfway between equal counts and equal widths.
            let even = low + (high - low) * share;
            0.5 * (even + quantile_or_zero(&mut all, 0.01 + 0.98 * share))
        })
        .collect();
    knots.dedup_by(|a, b| (*a - *b).abs() <= 1e-9 * (high - low).abs());
    knots
}

/// Values of the hat functions at `x`.
fn hats(knots: &[f64], x: f64, out: &mut Vec<f64>) {
    out.clear();
    out.resize(knots.len(), 0.0);
    let (Some(first), Some(last)) = (knots.first(), knots.last()) else {
        return;
    };
    let x = x.clamp(*first, *last);
    let upper = knots.iter().position(|k| *k >= x).unwrap_or(0);
    if upper == 0 {
        out[0] = 1.0;
        return;
    }
    let share = (x - knots[upper - 1]) / (knots[upper] - knots[upper - 1]);
    out[upper - 1] = 1.0 - share;
    out[upper] = share;
}

/// Columns of a map: as they are, times sign(q̇), or both.
pub(super) fn basis(
    prepared: &PreparedModel,
    chosen: &[&Channel],
    direction: Direction,
    knots_of_pair: usize,
) -> Vec<Vec<Vec<f64>>> {
    let fast: Vec<&&Channel> = chosen.iter().filter(|c| !c.slow).collect();
    let count = if fast.len() > 1 {
        knots_of_pair
    } else {
        KNOTS_ALONE
    };
    let all_knots: Vec<Vec<f64>> = fast.iter().map(|c| knots(c, count)).collect();
    let slow = chosen.iter().find(|c| c.slow);
    let mean = slow.map_or(0.0, |c| {
        let all: Vec<f64> = c.values.iter().flatten().copied().collect();
        all.iter().sum::<f64>() / all.len().max(1) as f64
    });
    let (mut first, mut second) = (Vec::new(), Vec::new());
    prepared
        .sessions
        .iter()
        .enumerate()
        .map(|(s, signals)| {
            let width = 2 * all_knots.iter().map(Vec::len).product::<usize>().max(1);
            let mut columns = vec![vec![0.0; signals.rows.len()]; width];
            for (row, at) in signals.rows.iter().enumerate() {
                let sign = signals.points[*at].sign();
                let scale = slow.map_or(1.0, |c| c.values[s][row] - mean);
                match all_knots.as_slice() {
                    [a] => {
                        hats(a, fast[0].values[s][row], &mut first);
                        second.clear();
                        second.push(1.0);
                    }
                    [a, b, ..] => {
                        hats(a, fast[0].values[s][row], &mut first);
                        hats(b, fast[1].values[s][row], &mut second);
                    }
                    [] => {
                        first.clear();
                        first.push(1.0);
                        second.clear();
                        second.push(1.0);
                    }
                }
                let half = width / 2;
                for (i, a) in first.iter().enumerate().filter(|(_, a)| **a != 0.0) {
                    for (j, b) in second.iter().enumerate() {
                        let value = a * b * scale;
                        columns[i * second.len() + j][row] = value;
                        columns[half + i * second.len() + j][row] = value * sign;
                    }
                }
            }
            let half = width / 2;
            match direction {
                Direction::Either => {}
                Direction::Same => columns.truncate(half),
                Direction::Opposite => {
                    columns.drain(..half);
                }
            }
            columns
        })
        .collect()
}
