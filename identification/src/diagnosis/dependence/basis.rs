//! Signals at the rows of the regression, and piecewise linear columns over them.

use nalgebra::DMatrix;

use crate::design::{BlockGrams, Design, PreparedModel};
use crate::effects::Direction;
use crate::numerics::gram::Gram;
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

/// The hat functions that are not zero at `x`, at most two: number and value.
fn hats(knots: &[f64], x: f64) -> impl Iterator<Item = (usize, f64)> + Clone + use<> {
    let (first, last) = (knots.first().copied(), knots.last().copied());
    let x = x.clamp(first.unwrap_or(x), last.unwrap_or(x));
    let upper = knots.iter().position(|k| *k >= x).unwrap_or(0);
    let share = match upper {
        0 => 1.0,
        _ => (x - knots[upper - 1]) / (knots[upper] - knots[upper - 1]),
    };
    let below = upper.saturating_sub(1);
    let both = [(below, 1.0 - share), (upper, share)];
    both.into_iter().filter(|(_, value)| *value != 0.0)
}

/// Products of a map's functions with each other and with the model's columns and y, over the
/// rows of a block in one direction of motion.
#[derive(Clone)]
struct Products {
    /// Function by function, the second no earlier than the first.
    own: DMatrix<f64>,
    /// Column by function, y the last.
    base: DMatrix<f64>,
}

impl Products {
    fn empty(functions: usize, columns: usize) -> Self {
        Self {
            own: DMatrix::zeros(functions, functions),
            base: DMatrix::zeros(columns, functions),
        }
    }

    /// Adds a row, at which these `functions` are not zero and the others are.
    fn add(&mut self, functions: &[(usize, f64)], base: &[&[f64]], row: usize) {
        for (number, (at, value)) in functions.iter().enumerate() {
            for (other, factor) in &functions[number..] {
                self.own[(*at, *other)] += value * factor;
            }
            let mut products = self.base.column_mut(*at);
            for (product, column) in products.iter_mut().zip(base) {
                *product += value * column[row];
            }
        }
    }
}

/// The design's Gram matrices with the columns of a map: hat functions as they are, times
/// sign(q̇), or both. Most are zero at a row: at most two of each signal are not.
pub(super) fn grams(
    prepared: &PreparedModel,
    design: &Design,
    chosen: &[&Channel],
    direction: Direction,
    knots_of_pair: usize,
) -> BlockGrams {
    let fast: Vec<&&Channel> = chosen.iter().filter(|c| !c.slow).collect();
    let count = if fast.len() > 1 {
        knots_of_pair
    } else {
        KNOTS_ALONE
    };
    let knots: Vec<Vec<f64>> = fast.iter().take(2).map(|c| knots(c, count)).collect();
    let functions = knots.iter().map(Vec::len).product::<usize>().max(1);
    let slow = chosen.iter().find(|c| c.slow);
    let mean = slow.map_or(0.0, |c| {
        let all: Vec<f64> = c.values.iter().flatten().copied().collect();
        all.iter().sum::<f64>() / all.len().max(1) as f64
    });
    let at_row = |s: usize, row: usize, out: &mut Vec<(usize, f64)>| {
        out.clear();
        let scale = slow.map_or(1.0, |c| c.values[s][row] - mean);
        let hats = |number: usize| hats(&knots[number], fast[number].values[s][row]);
        match knots.as_slice() {
            [] => out.push((0, scale)),
            [_] => out.extend(hats(0).map(|(at, value)| (at, value * scale))),
            [_, second, ..] => {
                let of_second = hats(1);
                for (i, a) in hats(0) {
                    let both = of_second.clone();
                    out.extend(both.map(|(j, b)| (i * second.len() + j, a * b * scale)));
                }
            }
        }
    };
    let sessions = design.sessions.iter().zip(&prepared.sessions).enumerate();
    let each = sessions.map(|(s, (session, signals))| {
        let base = session.base_and_measured();
        let mut of_row = Vec::with_capacity(4);
        let blocks = session.blocks.iter().zip(&session.grams);
        let each = blocks.map(|((from, to), gram)| {
            // By direction of motion: forwards, backwards, neither.
            let mut products = vec![Products::empty(functions, base.len()); 3];
            for row in *from..*to {
                at_row(s, row, &mut of_row);
                let of = match signals.points[signals.rows[row]].sign() {
                    sign if sign > 0.0 => 0,
                    sign if sign < 0.0 => 1,
                    _ => 2,
                };
                products[of].add(&of_row, &base, row);
            }
            put_together(gram, &products, direction)
        });
        each.collect()
    });
    each.collect()
}

/// The Gram of base columns, the map's columns and y, from that without the map and the
/// products in three directions.
fn put_together(base: &Gram, products: &[Products], direction: Direction) -> Gram {
    let [forwards, backwards, neither] = products else {
        return base.clone();
    };
    let functions = forwards.own.nrows();
    // Whether columns have the sign of motion.
    let kinds: &[bool] = match direction {
        Direction::Either => &[false, true],
        Direction::Same => &[false],
        Direction::Opposite => &[true],
    };
    let sum = |signs: [bool; 2], of: &dyn Fn(&Products) -> f64| -> f64 {
        match signs {
            [false, false] => of(forwards) + of(backwards) + of(neither),
            [true, true] => of(forwards) + of(backwards),
            _ => of(forwards) - of(backwards),
        }
    };
    let (p, m) = (base.columns(), functions * kinds.len());
    let place = |i: usize| if i < p { i } else { p + m };
    let mut gram = Gram::empty(p + m);
    gram.rows = base.rows;
    for i in 0..=p {
        for j in 0..=p {
            gram.products[(place(i), place(j))] = base.products[(i, j)];
        }
    }
    for (k, sign) in kinds.iter().enumerate() {
        for function in 0..functions {
            let at = p + k * functions + function;
            for i in 0..=p {
                let product = sum([*sign, false], &|own| own.base[(i, function)]);
                gram.products[(at, place(i))] = product;
                gram.products[(place(i), at)] = product;
            }
            for (l, other_sign) in kinds.iter().enumerate() {
                for other in 0..functions {
                    let (low, high) = (function.min(other), function.max(other));
                    let product = sum([*sign, *other_sign], &|own| own.own[(low, high)]);
                    gram.products[(at, p + l * functions + other)] = product;
                }
            }
        }
    }
    gram
}
