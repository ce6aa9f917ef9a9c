//! Terms of a formula: a coefficient times functions of signals.

use std::collections::BTreeMap;

use super::dimension::Dimension;
use super::shape::{Constant, Shape, unit_of};

/// A signal, as formulas name it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Signal {
    /// Its name in formulas.
    pub(super) name: String,
    /// Its name in results: `velocity`, `load`, ….
    pub(super) of_results: String,
    /// Its unit, for results.
    pub(super) unit: Dimension,
    /// The unit that it is read in, where that is not the one of its differences.
    pub(super) place_unit: Option<&'static str>,
}

/// A function of one signal with its constants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Factor {
    /// Which signal.
    pub(super) signal: usize,
    pub(super) shape: Shape,
    /// Place and scale, as far as the shape has them.
    pub(super) constants: [f64; 2],
}

/// A product of functions, which a coefficient multiplies.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Term {
    /// Whether it changes its sign with the direction of motion, beside what its
    /// factors do.
    pub(super) direction: bool,
    pub(super) factors: Vec<Factor>,
}

/// Which constant of a formula: term, factor, and 0 for a place, 1 for a scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct At {
    pub(super) term: usize,
    pub(super) factor: usize,
    pub(super) which: usize,
}

impl Term {
    /// Signals, functions, constants and signs that a reader has to take in.
    pub(super) fn complexity(&self) -> usize {
        let factors = self.factors.iter();
        let own: usize = factors.map(|factor| factor.shape.complexity() + 1).sum();
        own + 1 + if self.direction { 2 } else { 0 }
    }

    /// The signals and functions without the constants: two terms of one structure
    /// differ in numbers only.
    pub(super) fn structure(&self) -> (bool, Vec<(usize, Shape)>) {
        let factors = self.factors.iter();
        let mut all: Vec<_> = factors.map(|own| (own.signal, own.shape)).collect();
        all.sort_unstable();
        (self.direction, all)
    }

    /// The signals that it reads, by number; the velocity for a direction.
    pub(super) fn signals(&self) -> impl Iterator<Item = usize> {
        let direction = self.direction.then_some(VELOCITY);
        let factors: Vec<usize> = self.factors.iter().map(|own| own.signal).collect();
        direction.into_iter().chain(factors)
    }

    /// Whether it is J q̈, which every model has: filtered once more it is less noisy, and no law.
    pub(super) fn is_inertia(&self) -> bool {
        let is_plain = |own: &Factor| own.signal == ACCELERATION && own.shape == Shape::Linear;
        !self.direction && self.factors.len() == 1 && self.factors.iter().all(is_plain)
    }

    /// Unit of its coefficient.
    pub(super) fn unit(&self, signals: &[Signal]) -> Dimension {
        let mut unit = Dimension::force();
        for factor in &self.factors {
            if let Some(signal) = signals.get(factor.signal) {
                unit = unit.times(&unit_of(factor.shape, &signal.unit), -1.0);
            }
        }
        unit
    }
}

/// Number of the velocity among the signals.
pub(super) const VELOCITY: usize = 1;
/// The same of the acceleration.
pub(super) const ACCELERATION: usize = 2;

/// All constants of `terms` that are not coefficients.
pub(super) fn constants(terms: &[Term]) -> Vec<At> {
    let mut all = Vec::new();
    for (t, term) in terms.iter().enumerate() {
        for (f, factor) in term.factors.iter().enumerate() {
            let has = factor.shape.constants();
            let each = [(0, has.place), (1, has.scale)];
            for (which, _) in each.into_iter().filter(|(_, has)| *has) {
                all.push(At {
                    term: t,
                    factor: f,
                    which,
                });
            }
        }
    }
    all
}

/// The value of a constant.
pub(super) fn constant(terms: &[Term], at: At) -> f64 {
    let factor = terms
        .get(at.term)
        .and_then(|term| term.factors.get(at.factor));
    factor.map_or(0.0, |factor| factor.constants[at.which])
}

/// Puts a constant in place.
pub(super) fn set(terms: &mut [Term], at: At, value: f64) {
    let term = terms.get_mut(at.term);
    if let Some(factor) = term.and_then(|term| term.factors.get_mut(at.factor)) {
        factor.constants[at.which] = value;
    }
}

/// Names of the coefficients of `count` terms that no signal has.
pub(super) fn coefficient_names(count: usize, signals: &[Signal]) -> Vec<String> {
    let is_free = |letter: &&str| {
        let mut names = (1..=count).map(|number| format!("{letter}{number}"));
        names.all(|name| signals.iter().all(|own| own.name != name))
    };
    let letter = ["c", "k", "p", "coefficient_"]
        .into_iter()
        .find(is_free)
        .unwrap_or("parameter_");
    (1..=count)
        .map(|number| format!("{letter}{number}"))
        .collect()
}

/// Names of the constants, which no signal has: `q_0` a place, `q_s` a scale.
pub(super) fn constant_names(terms: &[Term], signals: &[Signal]) -> Vec<String> {
    let mut used: BTreeMap<String, usize> = BTreeMap::new();
    let name = |at: At| {
        let factor = terms
            .get(at.term)
            .and_then(|term| term.factors.get(at.factor));
        let signal = factor.and_then(|own| signals.get(own.signal));
        let signal = signal.map_or("x", |own| own.name.as_str());
        format!("{signal}_{}", ["0", "s"][at.which])
    };
    let each = constants(terms).into_iter().map(|at| {
        let plain = name(at);
        loop {
            let count = used.entry(plain.clone()).or_default();
            *count += 1;
            let own = match count {
                1 => plain.clone(),
                more => format!("{plain}_{more}"),
            };
            if signals.iter().all(|signal| signal.name != own) {
                return own;
            }
        }
    });
    each.collect()
}

/// What stands between the products of a formula.
pub(super) const SUM: &str = " + ";

/// The products that a formula is the sum of, as the lab reads them: with the `texts` of its
/// constants, in the order of [`constants`].
pub(super) fn in_products(
    terms: &[Term],
    signals: &[Signal],
    coefficients: &[String],
    texts: &[String],
) -> Vec<String> {
    let order = constants(terms);
    let name = |signal: usize| signals.get(signal).map_or("", |own| own.name.as_str());
    let of = |wanted: At| Constant {
        text: (order.iter().position(|at| *at == wanted))
            .and_then(|at| texts.get(at).cloned())
            .unwrap_or_default(),
    };
    let each = terms.iter().enumerate().map(|(t, term)| {
        let mut product = coefficients.get(t).cloned().unwrap_or_default();
        if term.direction {
            product += &format!("*sign({})", name(VELOCITY));
        }
        for (f, factor) in term.factors.iter().enumerate() {
            let at = |which| At {
                term: t,
                factor: f,
                which,
            };
            let (place, scale) = (of(at(0)), of(at(1)));
            product += "*";
            product += &factor.shape.text(name(factor.signal), [&place, &scale]);
        }
        product
    });
    each.collect()
}

/// `value` with `digits` significant digits, and the number that this text is.
pub(super) fn rounded(value: f64, digits: usize) -> (String, f64) {
    let scientific = format!("{:.*e}", digits.saturating_sub(1), value);
    let number: f64 = scientific.parse().unwrap_or(value);
    (format!("{number}"), number)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn signals() -> Vec<Signal> {
        let signal = |name: &str, unit| Signal {
            name: name.to_owned(),
            of_results: name.to_owned(),
            unit,
            place_unit: None,
        };
        vec![
            signal("q", Dimension::motion(0)),
            signal("qd", Dimension::motion(1)),
            signal("tau", Dimension::force()),
        ]
    }

    fn factor() -> impl Strategy<Value = Factor> {
        let place = prop_oneof![-3.0..3.0_f64, Just(0.0)];
        (0..3_usize, 0..Shape::ALL.len(), place, 0.02..5.0_f64).prop_map(
            |(signal, shape, place, scale)| Factor {
                signal,
                shape: Shape::ALL[shape],
                constants: [rounded(place, 3).1, rounded(scale, 3).1],
            },
        )
    }

    fn term() -> impl Strategy<Value = Term> {
        (any::<bool>(), prop::collection::vec(factor(), 1..=3))
            .prop_map(|(direction, factors)| Term { direction, factors })
    }

    proptest! {
        /// What is printed means, to the lab's own reader, what was searched.
        #[test]
        fn a_formula_that_is_printed_reads_back_as_itself(
            terms in prop::collection::vec(term(), 1..=3),
            x in prop::collection::vec(-2.0..2.0_f64, 3),
        ) {
            let signals = signals();
            let names = coefficient_names(terms.len(), &signals);
            let texts: Vec<String> = constants(&terms)
                .into_iter()
                .map(|at| format!("{}", constant(&terms, at)))
                .collect();
            let printed = in_products(&terms, &signals, &names, &texts).join(SUM);
            let weights = [0.7, -1.3, 2.1];
            let value = |name: &str| match name {
                "q" => x[0],
                "qd" => x[1],
                "tau" => x[2],
                other => names.iter().position(|own| own == other).map_or(f64::NAN, |at| weights[at]),
            };
            let read = crate::effects::expression::evaluate(&printed, &value).unwrap();
            let direct: f64 = terms.iter().zip(weights).map(|(term, weight)| {
                let direction = if term.direction { crate::effects::sign(x[VELOCITY]) } else { 1.0 };
                let product: f64 = term.factors.iter()
                    .map(|own| own.shape.value(x[own.signal], own.constants))
                    .product();
                weight * direction * product
            }).sum();
            let tolerance = 1e-9 * (1.0 + direct.abs());
            prop_assert!((read - direct).abs() <= tolerance || read == direct || !direct.is_finite(),
                "{printed}: read {read}, meant {direct}");
        }

        #[test]
        fn a_rounded_number_is_what_its_text_says(value in -1e6..1e6_f64, digits in 1..8_usize) {
            let (text, number) = rounded(value, digits);
            prop_assert_eq!(text.parse::<f64>().unwrap(), number);
            let unit = 10_f64.powi(1 - digits as i32);
            prop_assert!((number - value).abs() <= 0.51 * unit * value.abs());
        }
    }

    #[test]
    fn names_avoid_those_of_signals() {
        let mut all = signals();
        all.push(Signal {
            name: "c1".to_owned(),
            of_results: "c1".to_owned(),
            unit: Dimension::own("c1"),
            place_unit: None,
        });
        assert_eq!(coefficient_names(2, &all), ["k1", "k2"]);
        let step = Term {
            direction: false,
            factors: vec![Factor {
                signal: 0,
                shape: Shape::Step,
                constants: [-0.2, 0.1],
            }],
        };
        let terms = [step.clone(), step];
        let names = constant_names(&terms, &all);
        assert_eq!(names, ["q_0", "q_s", "q_0_2", "q_s_2"]);
        let texts = ["-0.2", "0.1", "-0.2", "0.1"].map(str::to_owned);
        assert_eq!(
            in_products(&terms[..1], &all, &["k1".to_owned()], &texts).join(SUM),
            "k1*tanh((q + 0.2)/0.1)"
        );
    }
}
