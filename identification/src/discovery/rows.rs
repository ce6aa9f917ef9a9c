//! The rows that a search works on: a part of those that are fitted, with what each
//! signal is under the filter of each row, so that a function of signals becomes
//! a column of the regression by the filter that every other column goes through.

use super::dimension::Dimension;
use super::term::{Signal, Term, VELOCITY};
use crate::design::{Design, PreparedModel};
use crate::diagnosis::dependence::Dependence;
use crate::effects::expression::signal_names;
use crate::numerics::statistics::quantile_or_zero;
use crate::signals::{Point, SECONDS_PER_DAY, Signals};

/// Rows that a search works on, at most …
const MAX_ROWS: usize = 3500;
/// … and samples under their filters.
const MAX_SAMPLES: usize = 120_000;
/// Samples under the filter of one row, at most: of a longer filter every second is
/// left out, or more.
const MAX_TAPS: usize = 41;
/// Extra signals that are searched, at most.
const MAX_EXTRAS: usize = 3;
/// Blocks of time in all, about: their signs are what is turned to see what chance does.
const BLOCKS: usize = 48;
/// Smallest number of rows in a block of time.
const MIN_BLOCK_ROWS: usize = 12;
/// A column of which the model explains all but this share has no part of its own.
const MIN_OWN_SHARE: f64 = 3e-4;

/// How the values of a signal lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Of both signs, zero is at rest.
    Velocity,
    /// Of one sign or both around a zero that means something.
    About,
    /// Anywhere: zero means nothing.
    Place,
    /// The same, and it hardly varies within a session.
    Slow,
}

/// A signal under the filters of all rows.
#[derive(Clone, Debug)]
pub(super) struct Channel {
    pub(super) signal: Signal,
    pub(super) kind: Kind,
    /// 2 % and 98 % of its values at the rows.
    pub(super) range: [f64; 2],
    /// Its value at every row.
    pub(super) values: Vec<f64>,
    /// Samples of the first row, of the second, ….
    samples: Vec<f64>,
}

/// The part of the rows that a search works on.
pub(super) struct Rows {
    /// Position, velocity, acceleration; then others.
    pub(super) channels: Vec<Channel>,
    taps: Vec<f64>,
    /// Rows of each session, and an orthonormal basis of what the model explains in it.
    sessions: Vec<(usize, usize, Vec<Vec<f64>>)>,
    /// What the model leaves of the measured side, each session by itself \[Nm\].
    pub(super) residual: Vec<f64>,
    /// First row and the row past the last, of each block of time.
    pub(super) blocks: Vec<(usize, usize)>,
    /// The number of the session of each block.
    pub(super) session_of: Vec<usize>,
}

/// The value of a signal at a working sample.
type Read = dyn Fn(&Signals, usize) -> f64;

/// A signal to be read: what it is, and its value at a working sample.
struct Source {
    signal: Signal,
    kind: Kind,
    read: Box<Read>,
}

impl Rows {
    /// Of the rows that `design` fits; extra signals in `first` come before others.
    pub(super) fn new(prepared: &PreparedModel, design: &Design, first: &[String]) -> Self {
        let all: usize = prepared.sessions.iter().map(|s| s.rows.len()).sum();
        let kernel = prepared.sessions.first().map(|s| s.column.taps().to_vec());
        let kernel = kernel.unwrap_or_else(|| vec![1.0]);
        let (taps, stride) = thinned(&kernel);
        let most = MAX_ROWS.min(MAX_SAMPLES / taps.len().max(1)).max(1);
        let step = all.div_ceil(most).max(1);
        let reach = (kernel.len() / 2) as isize;
        let mut channels: Vec<(Source, Vec<f64>, Vec<f64>)> = sources(prepared, first)
            .into_iter()
            .map(|source| (source, Vec::new(), Vec::new()))
            .collect();
        let mut rows = Self {
            channels: Vec::new(),
            taps,
            sessions: Vec::new(),
            residual: Vec::new(),
            blocks: Vec::new(),
            session_of: Vec::new(),
        };
        for (number, (signals, session)) in
            prepared.sessions.iter().zip(&design.sessions).enumerate()
        {
            let chosen: Vec<usize> = (step / 2..signals.rows.len()).step_by(step).collect();
            let last = signals.points.len() as isize - 1;
            for row in &chosen {
                let at = signals.rows[*row] as isize;
                for (source, samples, values) in &mut channels {
                    values.push((source.read)(signals, at as usize));
                    for tap in 0..rows.taps.len() {
                        let sample = at - reach + (tap * stride) as isize;
                        samples.push((source.read)(
                            signals,
                            sample.clamp(0, last.max(0)) as usize,
                        ));
                    }
                }
            }
            let pick = |column: &[f64]| -> Vec<f64> {
                let own = chosen.iter();
                own.map(|row| column.get(*row).copied().unwrap_or(0.0))
                    .collect()
            };
            let mut basis: Vec<Vec<f64>> = Vec::new();
            for column in &session.base {
                extend_basis(&mut basis, pick(column));
            }
            let mut residual = pick(&session.measured);
            take_out(&basis, &mut residual);
            let from = rows.residual.len();
            rows.residual.extend(residual);
            let to = rows.residual.len();
            rows.sessions.push((from, to, basis));
            let share = chosen.len() as f64 * BLOCKS as f64 / (all as f64 / step as f64).max(1.0);
            let count = (share.round() as usize).clamp(1, (chosen.len() / MIN_BLOCK_ROWS).max(1));
            for block in 0..count {
                let edge = |block: usize| from + block * (to - from) / count;
                rows.blocks.push((edge(block), edge(block + 1)));
                rows.session_of.push(number);
            }
        }
        rows.channels = channels
            .into_iter()
            .map(|(source, samples, values)| {
                let mut sorted = values.clone();
                Channel {
                    signal: source.signal,
                    kind: source.kind,
                    range: [0.02, 0.98].map(|share| quantile_or_zero(&mut sorted, share)),
                    values,
                    samples,
                }
            })
            .collect();
        rows
    }

    /// The numbers of the signals, in order, of every map over three.
    pub(super) fn triples(&self, maps: &[Dependence]) -> Vec<[usize; 3]> {
        let number = |name: &String| {
            let mut all = self.channels.iter();
            all.position(|own| &own.signal.of_results == name)
        };
        let each = maps.iter().filter_map(|map| {
            let numbers: Option<Vec<usize>> = map.signals.iter().map(number).collect();
            let mut triple: [usize; 3] = numbers?.try_into().ok()?;
            triple.sort_unstable();
            Some(triple)
        });
        each.collect()
    }

    /// Number of rows.
    pub(super) fn count(&self) -> usize {
        self.residual.len()
    }

    /// The signals, as formulas name them.
    pub(super) fn signals(&self) -> Vec<Signal> {
        self.channels.iter().map(|own| own.signal.clone()).collect()
    }

    /// The values of a factor under the filters of all rows.
    pub(super) fn factor(&self, factor: &super::term::Factor) -> Vec<f64> {
        let samples = self.channels.get(factor.signal).map(|own| &own.samples);
        let samples = samples.map_or(&[][..], Vec::as_slice);
        let value = |x: &f64| factor.shape.value(*x, factor.constants);
        samples.iter().map(value).collect()
    }

    /// The direction of motion under the filters of all rows.
    pub(super) fn direction(&self) -> Vec<f64> {
        let velocity = self.channels.get(VELOCITY).map(|own| &own.samples);
        let velocity = velocity.map_or(&[][..], Vec::as_slice);
        velocity.iter().map(|x| crate::effects::sign(*x)).collect()
    }

    /// What is left of a column by its values under the filters, once the model has
    /// explained its part in every session; `None` where nothing of it is its own.
    pub(super) fn column(&self, factors: &[&[f64]]) -> Option<Vec<f64>> {
        let width = self.taps.len();
        let mut column = Vec::with_capacity(self.count());
        for row in 0..self.count() {
            let at = row * width;
            let mut sum = 0.0;
            for (tap, weight) in self.taps.iter().enumerate() {
                let product: f64 = factors.iter().map(|own| own[at + tap]).product();
                sum += weight * product;
            }
            column.push(sum);
        }
        let whole = square(&column);
        for (from, to, basis) in &self.sessions {
            if let Some(own) = column.get_mut(*from..*to) {
                take_out(basis, own);
            }
        }
        let own = square(&column);
        (own.is_finite() && own > MIN_OWN_SHARE * whole && own > 1e-200).then_some(column)
    }

    /// The column of a term.
    pub(super) fn column_of(&self, term: &Term) -> Option<Vec<f64>> {
        let mut factors: Vec<Vec<f64>> = term.factors.iter().map(|own| self.factor(own)).collect();
        if term.direction {
            factors.push(self.direction());
        }
        let views: Vec<&[f64]> = factors.iter().map(Vec::as_slice).collect();
        self.column(&views)
    }
}

/// Every signal that a formula may read here.
fn sources(prepared: &PreparedModel, first: &[String]) -> Vec<Source> {
    let facts = &prepared.facts;
    let names = signal_names(facts.joint.subject());
    let source = |number: usize, of_joint: &str, unit, kind, read: fn(&Point) -> f64| Source {
        signal: Signal {
            name: names[number].to_owned(),
            of_results: facts.joint.signal(of_joint).to_owned(),
            unit,
            place_unit: None,
        },
        kind,
        read: Box::new(move |signals: &Signals, at| read(&signals.points[at])),
    };
    let motion = Dimension::motion;
    let mut all = vec![
        source(0, "position", motion(0), Kind::Place, |p| p.position),
        source(1, "velocity", motion(1), Kind::Velocity, |p| p.velocity),
        source(2, "acceleration", motion(2), Kind::About, |p| {
            p.acceleration
        }),
    ];
    if facts.loaded {
        all.push(source(3, "load", Dimension::force(), Kind::About, |p| {
            p.load
        }));
    }
    if facts.temperature && facts.temperature_range > 2.0 {
        let mean = facts.reference_temperature;
        all.push(Source {
            signal: Signal {
                name: names[5].to_owned(),
                of_results: "temperature".to_owned(),
                unit: Dimension::kelvin(),
                place_unit: Some("degC"),
            },
            kind: Kind::Slow,
            read: Box::new(move |signals, at| signals.points[at].temperature + mean),
        });
    }
    // The more signals, the more does as well by chance.
    if facts.no_dates().is_none() && first.iter().any(|own| own == "date") {
        all.push(Source {
            signal: Signal {
                name: names[6].to_owned(),
                of_results: "date".to_owned(),
                unit: Dimension::second(),
                place_unit: None,
            },
            kind: Kind::Slow,
            read: Box::new(|signals, at| signals.points[at].days * SECONDS_PER_DAY),
        });
    }
    let mut extras: Vec<String> = (prepared.sessions.first())
        .map(|s| s.extra.keys().cloned().collect())
        .unwrap_or_default();
    extras.sort_by_key(|name| !first.contains(name));
    for name in extras.into_iter().take(MAX_EXTRAS) {
        all.push(Source {
            signal: Signal {
                name: name.clone(),
                of_results: name.clone(),
                unit: Dimension::own(&name),
                place_unit: None,
            },
            kind: Kind::About,
            read: Box::new(move |signals, at| {
                let own = signals.extra.get(&name).and_then(|own| own.get(at));
                own.copied().unwrap_or(0.0)
            }),
        });
    }
    all
}

/// A kernel with as many taps as are affordable, and the samples between two.
fn thinned(kernel: &[f64]) -> (Vec<f64>, usize) {
    let stride = kernel.len().div_ceil(MAX_TAPS).max(1);
    let taps: Vec<f64> = kernel.iter().step_by(stride).copied().collect();
    let (all, kept): (f64, f64) = (kernel.iter().sum(), taps.iter().sum());
    let scale = if kept.abs() > 1e-12 { all / kept } else { 1.0 };
    (taps.into_iter().map(|tap| tap * scale).collect(), stride)
}

/// Adds what of `column` the basis does not have, unless that is nothing.
pub(super) fn extend_basis(basis: &mut Vec<Vec<f64>>, mut column: Vec<f64>) {
    let whole = square(&column);
    // Twice is enough (Kahan, Parlett).
    take_out(basis, &mut column);
    take_out(basis, &mut column);
    let own = square(&column);
    if own > 1e-10 * whole && own > 0.0 {
        let scale = own.sqrt().recip();
        column.iter_mut().for_each(|x| *x *= scale);
        basis.push(column);
    }
}

/// Takes out of `column` what an orthonormal basis explains.
pub(super) fn take_out(basis: &[Vec<f64>], column: &mut [f64]) {
    for own in basis {
        let along = dot(own, column);
        let both = column.iter_mut().zip(own);
        both.for_each(|(x, own)| *x -= along * own);
    }
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

pub(super) fn square(column: &[f64]) -> f64 {
    dot(column, column)
}
