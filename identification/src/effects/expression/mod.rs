//! Effects of the user's own, by formula.
//!
//! Numbers, `+ - * / ^`, parentheses, `pi`, and the functions `abs sign sqrt
//! exp ln sin cos tan asin acos atan sinh cosh tanh`. Every other name is a signal or a parameter.

mod grammar;
mod load;

use std::collections::BTreeMap;

use super::{Effect, EffectDescription, Facts, MAX_COLUMNS, Memory, Point, Quantity, Row, Unit};
use crate::data::error::ExpressionError;
use crate::data::{CustomEffect, Subject};
use crate::signals::{SECONDS_PER_DAY, Signals};
use ferntast_model::friction::Proposal;
use grammar::Formula;
pub use load::is_load;

/// Names of the signals that every recording may have: of a joint …
const OF_JOINT: [&str; 7] = ["q", "qd", "qdd", "tau", "tau_m", "T", "t"];
/// … and of a contact, in the same order.
const OF_CONTACT: [&str; 7] = ["r", "rd", "rdd", "F_N", "F_T", "T", "t"];

/// Names that mean a signal in expressions about `subject`.
#[must_use]
pub const fn signal_names(subject: Subject) -> [&'static str; 7] {
    match subject {
        Subject::Joint => OF_JOINT,
        Subject::Contact => OF_CONTACT,
    }
}

/// Names that nobody gives to a parameter: signals of the other subject, and what
/// signals are called in files and results.
const NAMES_OF_SIGNALS: [&str; 18] = [
    "qd",
    "qdd",
    "tau_m",
    "rd",
    "rdd",
    "F_N",
    "F_T",
    "position",
    "velocity",
    "acceleration",
    "load",
    "motor_torque",
    "joint_torque",
    "normal_force",
    "tangential_force",
    "temperature",
    "time",
    "date",
];

/// Names of the signals that formulas can read, separated by commas.
fn known_signals(facts: &Facts, extras: &[String]) -> String {
    let own = signal_names(facts.joint.subject()).into_iter();
    let own = own.filter(|name| *name != "T" || facts.temperature);
    let all: Vec<&str> = own.chain(extras.iter().map(String::as_str)).collect();
    all.join(", ")
}

/// Where the value of a variable of the formula comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Source {
    Signal(usize),
    Extra(usize),
    Linear(usize),
    Shape(usize),
}

/// A custom effect, ready to evaluate.
pub struct Compiled {
    description: EffectDescription,
    formula: Formula,
    sources: Vec<Source>,
    extra: Vec<String>,
    bounds: Vec<[f64; 2]>,
    linear: usize,
    reference_temperature: f64,
    is_load: bool,
}

impl Compiled {
    /// Reads a formula for recordings with these facts and signals.
    ///
    /// # Errors
    ///
    /// See [`ExpressionError`].
    pub fn new(
        custom: &CustomEffect,
        facts: &Facts,
        sessions: &[Signals],
    ) -> Result<Self, ExpressionError> {
        let effect = || custom.name.clone();
        let formula =
            Formula::parse(&custom.expression).map_err(|why| ExpressionError::Syntax {
                effect: effect(),
                expression: custom.expression.clone(),
                why,
            })?;
        check_bounds(custom, formula.names())?;
        let extras: Vec<String> = sessions
            .first()
            .map(|s| s.extra.keys().cloned().collect())
            .unwrap_or_default();
        let mut compiled = Self {
            description: describe(custom, facts.joint.subject()),
            sources: Vec::new(),
            extra: Vec::new(),
            bounds: Vec::new(),
            linear: 0,
            reference_temperature: facts.reference_temperature,
            is_load: is_load(custom, facts.joint.subject(), &extras),
            formula,
        };
        let names: Vec<String> = compiled.formula.names().to_vec();
        for name in &names {
            let source = compiled.source(custom, name, facts, &extras)?;
            compiled.sources.push(source);
        }
        if compiled.linear == 0 {
            return Err(ExpressionError::NoParameter {
                effect: effect(),
                expression: custom.expression.clone(),
            });
        }
        let searched = compiled.bounds.len();
        for (count, most) in [(compiled.linear, MAX_COLUMNS), (searched, 3)] {
            if count > most {
                return Err(ExpressionError::TooMany {
                    effect: effect(),
                    count,
                    most,
                });
            }
        }
        compiled.check_linear(custom, sessions, &known_signals(facts, &extras))?;
        compiled.check_finite(sessions)?;
        Ok(compiled)
    }

    fn source(
        &mut self,
        custom: &CustomEffect,
        name: &str,
        facts: &Facts,
        extras: &[String],
    ) -> Result<Source, ExpressionError> {
        if let Some(bounds) = custom.bounds.get(name) {
            self.bounds.push(*bounds);
            self.description.shape.push(quantity(name));
            return Ok(Source::Shape(self.bounds.len() - 1));
        }
        let signals = signal_names(facts.joint.subject());
        let missing = || ExpressionError::MissingSignal {
            effect: custom.name.clone(),
            signal: name.to_owned(),
            known: known_signals(facts, extras),
        };
        if let Some(at) = signals.iter().position(|s| *s == name) {
            if name == "T" && !facts.temperature {
                return Err(missing());
            }
            return Ok(Source::Signal(at));
        }
        if extras.iter().any(|e| e == name) {
            self.extra.push(name.to_owned());
            return Ok(Source::Extra(self.extra.len() - 1));
        }
        if NAMES_OF_SIGNALS.contains(&name) {
            return Err(missing());
        }
        self.linear += 1;
        self.description.coefficients.push(quantity(name));
        Ok(Source::Linear(self.linear - 1))
    }

    fn value(&self, shape: &[f64], linear: &[f64], point: &Point, extra: &[f64]) -> f64 {
        let signals = [
            point.position,
            point.velocity,
            point.acceleration,
            point.load,
            point.motor_torque,
            point.temperature + self.reference_temperature,
            point.days * SECONDS_PER_DAY,
        ];
        let mut values = [0.0; grammar::MAX_NAMES];
        for (value, source) in values.iter_mut().zip(&self.sources) {
            *value = match source {
                Source::Signal(i) => signals[*i],
                Source::Extra(i) => extra.get(*i).copied().unwrap_or(0.0),
                Source::Linear(i) => linear.get(*i).copied().unwrap_or(0.0),
                Source::Shape(i) => shape.get(*i).copied().unwrap_or(0.0),
            };
        }
        self.formula.value(&values[..self.sources.len()])
    }

    /// Middle of the bounds.
    fn middle(&self) -> Vec<f64> {
        self.bounds.iter().map(|b| 0.5 * (b[0] + b[1])).collect()
    }

    fn samples<'a>(
        &'a self,
        sessions: &'a [Signals],
        count: usize,
    ) -> impl Iterator<Item = (&'a Signals, usize, Vec<f64>)> + 'a {
        sessions.iter().flat_map(move |signals| {
            let step = (signals.points.len() / count).max(1);
            (0..signals.points.len()).step_by(step).map(move |at| {
                let extra = self
                    .extra
                    .iter()
                    .map(|name| {
                        signals
                            .extra
                            .get(name)
                            .and_then(|s| s.get(at))
                            .copied()
                            .unwrap_or(0.0)
                    })
                    .collect();
                (signals, at, extra)
            })
        })
    }

    /// Every parameter without bounds must enter linearly, and nothing may be
    /// left when all of them are zero.
    fn check_linear(
        &self,
        custom: &CustomEffect,
        sessions: &[Signals],
        known: &str,
    ) -> Result<(), ExpressionError> {
        let shape = self.middle();
        for (signals, at, extra) in self.samples(sessions, 40) {
            let point = &signals.points[at];
            let value = |linear: &[f64]| self.value(&shape, linear, point, &extra);
            let zero = value(&vec![0.0; self.linear]);
            let unit = |at: usize, size: f64| {
                let mut linear = vec![0.0; self.linear];
                linear[at] = size;
                linear
            };
            let ones: Vec<f64> = (0..self.linear).map(|i| value(&unit(i, 1.0))).collect();
            let together = value(&vec![1.0; self.linear]);
            let scale = ones.iter().fold(together.abs(), |a, b| a.max(b.abs())) + 1e-12;
            if zero.is_finite() && zero.abs() > 1e-9 * scale {
                return Err(ExpressionError::NoParameter {
                    effect: custom.name.clone(),
                    expression: custom.expression.clone(),
                });
            }
            let is_bent = |i: usize| {
                let twice = value(&unit(i, -2.5));
                (twice + 2.5 * ones[i]).abs() > 1e-7 * scale
                    || twice.is_finite() != ones[i].is_finite()
            };
            let all = 0..self.linear;
            let mut culprits: Vec<usize> = all.clone().filter(|i| is_bent(*i)).take(1).collect();
            if culprits.is_empty() && (together - ones.iter().sum::<f64>()).abs() > 1e-7 * scale {
                // Two that depend on each other, else all.
                let crossed = |i: usize, j: usize| {
                    let mut both = unit(i, 1.0);
                    both[j] = 1.0;
                    (value(&both) - ones[i] - ones[j]).abs() > 1e-7 * scale
                };
                let mut pairs = all.clone().flat_map(|j| (0..j).map(move |i| (i, j)));
                culprits = match pairs.find(|(i, j)| crossed(*i, *j)) {
                    Some((i, j)) => vec![i, j],
                    None => all.collect(),
                };
            }
            if !culprits.is_empty() {
                let name = |i: usize| {
                    self.description
                        .coefficients
                        .get(i)
                        .map(|own| own.name.clone())
                };
                return Err(ExpressionError::NotLinear {
                    effect: custom.name.clone(),
                    parameters: culprits.into_iter().filter_map(name).collect(),
                    signals: known.to_owned(),
                });
            }
        }
        Ok(())
    }

    fn check_finite(&self, sessions: &[Signals]) -> Result<(), ExpressionError> {
        let linear = vec![1.0; self.linear];
        let shapes = [
            self.bounds.iter().map(|b| b[0]).collect::<Vec<f64>>(),
            self.bounds.iter().map(|b| b[1]).collect(),
            self.middle(),
        ];
        for (signals, at, extra) in self.samples(sessions, usize::MAX) {
            for shape in &shapes {
                if !self
                    .value(shape, &linear, &signals.points[at], &extra)
                    .is_finite()
                {
                    return Err(ExpressionError::NotFinite {
                        effect: self.description.id.clone(),
                        session: signals.name.clone(),
                        time: signals.time(at),
                    });
                }
            }
        }
        Ok(())
    }
}

impl Effect for Compiled {
    fn description(&self) -> &EffectDescription {
        &self.description
    }

    fn row(&self) -> &'static Row {
        match self.is_load {
            true => &load::ROW,
            false => &Row::NONE,
        }
    }

    fn bounds(&self, _facts: &Facts) -> Vec<[f64; 2]> {
        self.bounds.clone()
    }

    fn evaluate(&self, shape: &[f64], point: &Point, memory: &mut Memory, columns: &mut [f64]) {
        self.evaluate_with(shape, point, &[], memory, columns);
    }

    fn extra(&self) -> &[String] {
        &self.extra
    }

    fn evaluate_with(
        &self,
        shape: &[f64],
        point: &Point,
        extra: &[f64],
        _memory: &mut Memory,
        columns: &mut [f64],
    ) {
        let mut linear = [0.0; MAX_COLUMNS];
        for (at, column) in columns.iter_mut().enumerate().take(self.linear) {
            linear[at] = 1.0;
            let value = self.value(shape, &linear[..self.linear], point, extra);
            // Checked at both bounds and between; a pole elsewhere counts for nothing.
            *column = if value.is_finite() { value } else { 0.0 };
            linear[at] = 0.0;
        }
    }
}

/// The value of an expression where `value` gives those of its names.
#[cfg(test)]
pub(crate) fn evaluate(expression: &str, value: &dyn Fn(&str) -> f64) -> Result<f64, String> {
    let formula = Formula::parse(expression)?;
    let values: Vec<f64> = formula.names().iter().map(|name| value(name)).collect();
    Ok(formula.value(&values))
}

fn quantity(name: &str) -> Quantity {
    Quantity {
        name: name.to_owned(),
        unit: Unit::same("as in the expression"),
    }
}

fn describe(custom: &CustomEffect, of: Subject) -> EffectDescription {
    let (force, shown_by) = match of {
        Subject::Joint => ("τ_F", Proposal::LoadSteps),
        Subject::Contact => ("F_T", Proposal::ContactForces),
    };
    EffectDescription {
        id: custom.name.clone(),
        of,
        equation: format!("{force} = {}", custom.expression),
        source: "the user's own".to_owned(),
        coefficients: Vec::new(),
        shape: Vec::new(),
        shows_as: "as the expression says".to_owned(),
        excited_by: "motion over which the expression varies".to_owned(),
        shown_by,
        of_unmeasured: None,
        another: None,
        confusable_with: Vec::new(),
    }
}

fn check_bounds(custom: &CustomEffect, names: &[String]) -> Result<(), ExpressionError> {
    let bounds: &BTreeMap<String, [f64; 2]> = &custom.bounds;
    for (parameter, [lower, upper]) in bounds {
        if !(lower.is_finite() && upper.is_finite() && lower < upper) {
            return Err(ExpressionError::Bounds {
                effect: custom.name.clone(),
                parameter: parameter.clone(),
                lower: *lower,
                upper: *upper,
            });
        }
        if !names.contains(parameter) {
            return Err(ExpressionError::UnusedBounds {
                effect: custom.name.clone(),
                parameter: parameter.clone(),
            });
        }
    }
    Ok(())
}
