//! Signals at the rows of the regression, and piecewise linear columns over them.

use std::cell::OnceCell;

use crate::design::{BlockGrams, Design, PreparedModel};
use crate::effects::{Direction, LOAD_OF};
use crate::numerics::filter::Kernel;
use crate::numerics::gram::Gram;
use crate::numerics::statistics::quantile_or_zero;
use crate::signals::{Point, Signals};

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
    /// Hat functions over it, by the number of knots asked for; made once.
    hats: [OnceCell<Hats>; 3],
}

/// Hat functions over a signal.
struct Hats {
    knots: usize,
    /// At the rows of every session.
    rows: Vec<Vec<Hat>>,
}

/// The hat functions that are not zero at a row, at most two neighbours.
#[derive(Clone, Copy)]
struct Hat {
    first: usize,
    /// Of the first and of the next.
    values: [f64; 2],
}

impl Hat {
    fn new(knots: &[f64], x: f64) -> Self {
        let (first, last) = (knots.first().copied(), knots.last().copied());
        let x = x.clamp(first.unwrap_or(x), last.unwrap_or(x));
        match knots.iter().position(|k| *k >= x).unwrap_or(0) {
            0 => Self {
                first: 0,
                values: [1.0, 0.0],
            },
            upper => {
                let share = (x - knots[upper - 1]) / (knots[upper] - knots[upper - 1]);
                Self {
                    first: upper - 1,
                    values: [1.0 - share, share],
                }
            }
        }
    }

    /// Number and value of both, of which one may be zero.
    const fn both(self) -> [(usize, f64); 2] {
        let [first, next] = self.values;
        [(self.first, first), (self.first + 1, next)]
    }
}

impl Channel {
    fn new(name: &str, slow: bool, values: Vec<Vec<f64>>) -> Self {
        Self {
            name: name.to_owned(),
            values,
            slow,
            hats: Default::default(),
        }
    }

    fn hats(&self, count: usize) -> &Hats {
        let at = match count {
            KNOTS_ALONE => 0,
            KNOTS_PAIR => 1,
            _ => 2,
        };
        self.hats[at].get_or_init(|| {
            let knots = knots(self, count);
            let hats = |values: &Vec<f64>| values.iter().map(|x| Hat::new(&knots, *x)).collect();
            Hats {
                rows: self.values.iter().map(hats).collect(),
                knots: knots.len(),
            }
        })
    }
}

/// Every signal on which the residual may depend.
///
/// The noise of the acceleration, and of a torque of the load, is in the residual itself. A map over a
/// signal with the same noise would find it there, on rows left out, too: so these are smoothed more
/// broadly than what is fitted. (A contact has no acceleration in its model.)
fn channels(prepared: &PreparedModel) -> Vec<Channel> {
    let facts = &prepared.facts;
    let is_contact = facts.joint.is_contact();
    let sessions = prepared.sessions.iter();
    let kernels: Vec<[Kernel; 2]> = sessions
        .map(|s| prepared.filters.broad_kernels(s.period))
        .collect();
    let broad = |name: &str, value: &dyn Fn(&Signals, &[Kernel; 2]) -> Vec<f64>| {
        let sessions = prepared.sessions.iter().zip(&kernels);
        let values = sessions.map(|(s, kernels)| value(s, kernels)).collect();
        Channel::new(facts.joint.signal(name), false, values)
    };
    let collect = |name: &str, slow: bool, value: &dyn Fn(&Signals, usize) -> f64| {
        let sessions = prepared.sessions.iter();
        let values = sessions.map(|s| s.rows.iter().map(|at| value(s, *at)).collect());
        Channel::new(facts.joint.signal(name), slow, values.collect())
    };
    let mut all = vec![
        collect("position", false, &|s, at| s.points[at].position),
        collect("velocity", false, &|s, at| s.points[at].velocity.abs()),
        broad("acceleration", &|s, [_, curvature]| {
            curvature.at_samples(&s.raw.position, &s.rows)
        }),
        collect("time", false, &|s, at| s.time(at)),
    ];
    if facts.loaded {
        type Value = fn(&Point) -> f64;
        let named: [(&str, Value); 2] = [
            ("load", |point| point.load),
            ("load_rate", |point| point.load_rate),
        ];
        for (name, value) in named {
            all.push(match is_contact {
                true => collect(name, false, &|s, at| value(&s.points[at])),
                false => broad(name, &|s, [smooth, _]| {
                    let values: Vec<f64> = s.points.iter().map(value).collect();
                    smooth.at_samples(&values, &s.rows)
                }),
            });
        }
    }
    if facts.temperature && facts.temperature_range > 2.0 && facts.sessions >= 4 {
        all.push(collect("temperature", true, &|s, at| {
            s.points[at].temperature
        }));
    }
    if facts.no_dates().is_none() {
        all.push(collect("date", true, &|s, at| s.points[at].days));
    }
    let names: Vec<String> = prepared
        .sessions
        .first()
        .map(|s| s.extra.keys().cloned().collect())
        .unwrap_or_default();
    for name in names {
        if name.starts_with(LOAD_OF) {
            all.push(broad(&name, &|s, [smooth, _]| {
                let load = s.extra.get(&name);
                load.map_or(vec![0.0; s.rows.len()], |own| {
                    smooth.at_samples(own, &s.rows)
                })
            }));
            continue;
        }
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

/// Products of a map's functions with each other and with the model's columns and y, over the
/// rows of a block in one direction of motion.
#[derive(Clone)]
struct Products {
    functions: usize,
    columns: usize,
    /// Function by function, the second no earlier than the first.
    own: Vec<f64>,
    /// Function by column, y the last.
    base: Vec<f64>,
}

impl Products {
    fn empty(functions: usize, columns: usize) -> Self {
        Self {
            functions,
            columns,
            own: vec![0.0; functions * functions],
            base: vec![0.0; functions * columns],
        }
    }

    /// Adds a row, at which these `functions` are not zero and the others are; `base` are the
    /// model's columns and y there.
    fn add(&mut self, functions: &[(usize, f64)], base: &[f64]) {
        for (number, (at, value)) in functions.iter().enumerate() {
            let own = &mut self.own[at * self.functions..][..self.functions];
            for (other, factor) in &functions[number..] {
                own[*other] += value * factor;
            }
            let products = &mut self.base[at * self.columns..][..self.columns];
            for (product, column) in products.iter_mut().zip(base) {
                *product += value * column;
            }
        }
    }

    fn own(&self, function: usize, other: usize) -> f64 {
        self.own[function.min(other) * self.functions + function.max(other)]
    }

    fn base(&self, column: usize, function: usize) -> f64 {
        self.base[function * self.columns + column]
    }
}

/// Rows of a session as maps are fitted to them.
struct SessionRows {
    /// The model's columns and y, row by row.
    base: Vec<f64>,
    /// Direction of motion: forwards, backwards, neither.
    direction: Vec<usize>,
}

/// How a signal that hardly varies within a session enters a map.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Slow {
    /// Its deviation from the mean times every function.
    Times,
    /// The same, and every function without it: what grows from zero instead of from the mean.
    AndWithout,
}

/// A model with the signals over which its residual is mapped.
pub(super) struct Ground<'a> {
    pub(super) channels: Vec<Channel>,
    design: &'a Design,
    sessions: Vec<SessionRows>,
}

impl<'a> Ground<'a> {
    pub(super) fn new(prepared: &PreparedModel, design: &'a Design) -> Self {
        let sessions = design.sessions.iter().zip(&prepared.sessions);
        let sessions = sessions.map(|(session, signals)| {
            let columns = session.base_and_measured();
            let rows = 0..session.measured.len();
            let direction = |at: &usize| match signals.points[*at].sign() {
                sign if sign > 0.0 => 0,
                sign if sign < 0.0 => 1,
                _ => 2,
            };
            SessionRows {
                base: rows
                    .flat_map(|row| columns.iter().map(move |column| column[row]))
                    .collect(),
                direction: signals.rows.iter().map(direction).collect(),
            }
        });
        Self {
            channels: channels(prepared),
            design,
            sessions: sessions.collect(),
        }
    }

    /// The design's Gram matrices with the columns of a map over `chosen` channels: hat functions
    /// as they are, times sign(q̇), or both. Most are zero at a row: at most two of each signal
    /// are not.
    pub(super) fn grams(
        &self,
        chosen: &[&Channel],
        direction: Direction,
        knots_of_pair: usize,
        slow_enters: Slow,
    ) -> BlockGrams {
        let fast: Vec<&&Channel> = chosen.iter().filter(|c| !c.slow).collect();
        let count = if fast.len() > 1 {
            knots_of_pair
        } else {
            KNOTS_ALONE
        };
        let hats: Vec<&Hats> = fast.iter().take(2).map(|c| c.hats(count)).collect();
        let over_fast = hats.iter().map(|own| own.knots).product::<usize>().max(1);
        let slow = chosen.iter().find(|c| c.slow);
        let functions = match slow_enters {
            Slow::Times => over_fast,
            Slow::AndWithout => 2 * over_fast,
        };
        let mean = slow.map_or(0.0, |c| {
            let all: Vec<f64> = c.values.iter().flatten().copied().collect();
            all.iter().sum::<f64>() / all.len().max(1) as f64
        });
        let at_row = |s: usize, row: usize, out: &mut Vec<(usize, f64)>| {
            out.clear();
            match hats.as_slice() {
                [] => out.push((0, 1.0)),
                [only] => {
                    for (i, a) in only.rows[s][row].both() {
                        if a != 0.0 {
                            out.push((i, a));
                        }
                    }
                }
                [first, second, ..] => {
                    let of_second = second.rows[s][row].both();
                    for (i, a) in first.rows[s][row].both() {
                        for (j, b) in of_second {
                            if a != 0.0 && b != 0.0 {
                                out.push((i * second.knots + j, a * b));
                            }
                        }
                    }
                }
            }
            let scale = slow.map_or(1.0, |c| c.values[s][row] - mean);
            for at in 0..out.len() {
                let (function, value) = out[at];
                out[at].1 = value * scale;
                if slow_enters == Slow::AndWithout {
                    out.push((over_fast + function, value));
                }
            }
        };
        let columns = self.design.base + 1;
        let sessions = self.design.sessions.iter().zip(&self.sessions).enumerate();
        let each = sessions.map(|(s, (session, rows))| {
            let mut of_row = Vec::with_capacity(8);
            let blocks = session.blocks.iter().zip(&session.grams);
            let each = blocks.map(|((from, to), gram)| {
                let mut products = vec![Products::empty(functions, columns); 3];
                for row in *from..*to {
                    at_row(s, row, &mut of_row);
                    let base = &rows.base[row * columns..][..columns];
                    products[rows.direction[row]].add(&of_row, base);
                }
                put_together(gram, &products, direction)
            });
            each.collect()
        });
        each.collect()
    }
}

/// The Gram of base columns, the map's columns and y, from that without the map and the
/// products in three directions.
fn put_together(base: &Gram, products: &[Products], direction: Direction) -> Gram {
    let [forwards, backwards, neither] = products else {
        return base.clone();
    };
    let functions = forwards.functions;
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
                let product = sum([*sign, false], &|own| own.base(i, function));
                gram.products[(at, place(i))] = product;
                gram.products[(place(i), at)] = product;
            }
            for (l, other_sign) in kinds.iter().enumerate() {
                for other in 0..functions {
                    let product = sum([*sign, *other_sign], &|own| own.own(function, other));
                    gram.products[(at, p + l * functions + other)] = product;
                }
            }
        }
    }
    gram
}
