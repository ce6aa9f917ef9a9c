//! Which of the formulas found are proposed: judged as they are printed, on rows left
//! out with shared parameters.

use std::cell::OnceCell;
use std::collections::BTreeMap;

use ferntast_model::friction::Proposal;

use super::constants::errors;
use super::fitted::Fitted;
use super::map::draw;
use super::results::Formula;
use super::rows::{Kind, Rows};
use super::search::SIGNIFICANCE;
use super::slower::Slower;
use super::state::State;
use super::term::{
    SUM, Signal, Term as FormulaTerm, coefficient_names, constant, constant_names, constants,
    in_products, rounded, set,
};
use crate::data::{CustomEffect, Subject, Term};
use crate::diagnosis::NamedCandidate;
use crate::diagnosis::confirmation::noisy_signals;
use crate::fit::Parameter;
use crate::numerics::statistics::f_tail;
use crate::validation::left_out::LeftOut;

/// Formulas of so many terms that are judged.
const JUDGED: [usize; 3] = [4, 4, 3];
/// Largest p-value of a coefficient between sessions: whether anything is there is told
/// by blocks of time, this one only whether it goes with what differs between sessions.
const BETWEEN_SESSIONS: f64 = 0.05;
/// Smallest share of the mean square that a formula explains.
const MIN_SHARE: f64 = 0.01;
/// A simpler formula that leaves at most this error, as a ratio, is as good, …
const EQUAL: f64 = 1.015;
/// … and so is one that leaves at most this one where the difference is not certain.
const NEARLY_EQUAL: f64 = 1.04;
/// A more complex formula is proposed beside a simpler one where it leaves less than this.
const CLEARLY_LESS: f64 = 0.99;
/// Formulas that are named as not to be told from one, at most.
const MAX_RIVALS: usize = 4;
/// Name under which a formula is judged and proposed; with a number where the model
/// has it already.
const NAME: &str = "formula";

/// What formulas are judged by.
pub(super) struct Judge<'a> {
    fitted: Fitted<'a>,
    rows: &'a Rows,
    /// Made where a formula is in doubt.
    slower: OnceCell<Slower<'a>>,
}

/// A formula as it is printed, in the model.
struct Judged {
    formula: Formula,
    left_out: LeftOut,
    signals: Vec<usize>,
}

impl<'a> Judge<'a> {
    /// By the model as it is `fitted`, on `rows` of it.
    pub(super) fn new(fitted: Fitted<'a>, rows: &'a Rows) -> Self {
        Self {
            fitted,
            rows,
            slower: OnceCell::new(),
        }
    }

    /// The formulas to propose, best first; where an effect is `named`, those that are
    /// certainly better than it.
    pub(super) fn best(
        &self,
        found: Vec<State>,
        named: Option<&NamedCandidate>,
        progress: &mut dyn FnMut(f64),
    ) -> Vec<Formula> {
        let mut chosen: Vec<State> = Vec::new();
        for (fewer, most) in JUDGED.into_iter().enumerate() {
            let of_length = found.iter().filter(|own| own.terms.len() == fewer + 1);
            chosen.extend(of_length.take(most).cloned());
        }
        let count = chosen.len().max(1) as f64;
        let named = named.and_then(|own| {
            let effect = Term::Catalogue(own.effect.clone());
            self.fitted.left_out(Some(&effect))
        });
        let mut judged: Vec<Judged> = Vec::new();
        for (number, state) in chosen.iter().enumerate() {
            let own = self.judge(state);
            let is_better = |own: &Judged| {
                (named.as_ref()).is_none_or(|named| {
                    let decrease = own.left_out.decrease_from(named);
                    decrease.is_certain() && decrease.after < CLEARLY_LESS * decrease.before
                })
            };
            judged.extend(own.filter(is_better));
            progress((number + 1) as f64 / count);
        }
        judged.sort_by(|a, b| {
            let error = |own: &Judged| own.formula.held_out_after;
            error(a).total_cmp(&error(b))
        });
        self.ranked(judged)
    }

    /// A formula as it is printed, where it lowers the error and is no chance.
    fn judge(&self, state: &State) -> Option<Judged> {
        let signals = self.rows.signals();
        let errors = errors(self.rows, &state.terms)?;
        let (of_coefficients, of_constants) = errors.split_at(state.terms.len());
        let mut terms = state.terms.clone();
        let order = constants(&terms);
        let mut texts = Vec::new();
        for (at, error) in order.iter().zip(of_constants) {
            let value = constant(&terms, *at);
            let (text, number) = rounded(value, digits(value, *error));
            set(&mut terms, *at, number);
            texts.push(text);
        }
        let coefficients = coefficient_names(terms.len(), &signals);
        let names = constant_names(&terms, &signals);
        let products = in_products(&terms, &signals, &coefficients, &texts);
        let name = self.free_name();
        let effect = CustomEffect {
            name: name.clone(),
            expression: products.join(SUM),
            bounds: BTreeMap::new(),
        };
        let (addition, left_out) = self.fitted.with(&Term::Custom(effect.clone()))?;
        let decrease = addition.decrease;
        let [share, _] = decrease.share();
        let mut parameters = BTreeMap::new();
        let mut holds = true;
        let mut freedom = 1.0;
        let own = addition.parameters.values();
        let own = own.filter(|parameter| parameter.effect == name);
        for (((own, term), fitted), error) in coefficients
            .iter()
            .zip(&terms)
            .zip(own)
            .zip(of_coefficients)
        {
            let conditional = fitted.std_error.unwrap_or(0.0);
            holds &= self.holds_between_sessions(term, fitted);
            freedom = fitted.freedom.unwrap_or(freedom);
            let parameter = Parameter::measured(
                fitted.value,
                // What places and scales may be makes a coefficient less certain.
                (conditional.max(*error), freedom),
                &term.unit(&signals).text(self.fitted.prepared.facts.joint),
                &name,
            );
            parameters.insert(own.clone(), parameter);
        }
        for ((at, own), error) in order.iter().zip(&names).zip(of_constants) {
            let parameter = Parameter::measured(
                constant(&terms, *at),
                (*error, freedom),
                &self.unit_of_constant(&terms, at, &signals),
                &name,
            );
            parameters.insert(own.clone(), parameter);
        }
        let read = read_by(&terms);
        let named = read.iter().filter_map(|at| signals.get(*at));
        let formula = Formula {
            name,
            form: in_products(&terms, &signals, &coefficients, &names).join(SUM),
            expression: effect.expression.clone(),
            parameters,
            signals: named.map(|own| own.of_results.clone()).collect(),
            held_out_before: addition.held_out_before,
            held_out_after: addition.held_out_after,
            share,
            share_std_error: decrease.std_error / decrease.before.powi(2).max(1e-300),
            p_value: state.p_value,
            complexity: state.complexity(),
            cannot_be_told_from: Vec::new(),
            next_experiment: Proposal::LoadSteps,
            separate_by: String::new(),
            map: draw(
                self.rows,
                &terms,
                &signals,
                &read,
                self.fitted.prepared.facts.joint,
            ),
        };
        let is_certain = addition.lowers_error && holds && share > MIN_SHARE;
        let is_certain = is_certain && state.p_value <= SIGNIFICANCE;
        let each: Vec<_> = products.into_iter().zip(&terms).collect();
        let is_certain = is_certain && self.is_no_noise(&effect, &each, &left_out);
        is_certain.then_some(Judged {
            formula,
            left_out,
            signals: read,
        })
    }

    /// Whether the terms over signals that have noise of the acceleration explain something with a slower
    /// filter, too. `formula` is the sum of `products`, each with its term, and leaves `left_out`.
    fn is_no_noise(
        &self,
        formula: &CustomEffect,
        products: &[(String, &FormulaTerm)],
        left_out: &LeftOut,
    ) -> bool {
        let noisy = noisy_signals(self.fitted.prepared);
        let signals = self.rows.signals();
        let is_doubtful = |term: &FormulaTerm| {
            let mut own = term.signals().filter_map(|at| signals.get(at));
            own.any(|own| noisy.contains(&own.of_results))
        };
        let rest: Vec<&str> = (products.iter())
            .filter(|(_, term)| !is_doubtful(term))
            .map(|(product, _)| product.as_str())
            .collect();
        if rest.len() == products.len() {
            return true;
        }
        let rest = (!rest.is_empty()).then(|| {
            Term::Custom(CustomEffect {
                expression: rest.join(SUM),
                ..formula.clone()
            })
        });
        let Fitted { filtered, spec, .. } = self.fitted;
        let slower = (self.slower).get_or_init(|| Slower::new(filtered, spec));
        let before = self.fitted.left_out(rest.as_ref());
        before.is_some_and(|before| {
            let here = left_out.decrease_from(&before);
            slower.confirms(&Term::Custom(formula.clone()), rest.as_ref(), here)
        })
    }

    /// A name that no effect of the model has.
    fn free_name(&self) -> String {
        let is_free = |name: &String| {
            self.fitted
                .spec
                .effects
                .iter()
                .all(|own| own.name() != name)
        };
        let numbered = (2..).map(|number| format!("{NAME}_{number}"));
        let mut names = std::iter::once(NAME.to_owned()).chain(numbered);
        names.find(is_free).unwrap_or_default()
    }

    /// Whether the coefficient of what hardly varies within a session, of which there
    /// are as many values as sessions, holds from one session to the other.
    fn holds_between_sessions(&self, term: &FormulaTerm, fitted: &Parameter) -> bool {
        let kind = |signal: usize| self.rows.channels.get(signal).map(|own| own.kind);
        if term.signals().all(|own| kind(own) != Some(Kind::Slow)) {
            return true;
        }
        let error = fitted.std_error.unwrap_or(f64::INFINITY).max(1e-300);
        let freedom = self.fitted.prepared.facts.sessions as f64 - 1.0;
        f_tail((fitted.value / error).powi(2), 1.0, freedom) < BETWEEN_SESSIONS
    }

    fn unit_of_constant(
        &self,
        terms: &[FormulaTerm],
        at: &super::term::At,
        signals: &[Signal],
    ) -> String {
        let factor = terms
            .get(at.term)
            .and_then(|own| own.factors.get(at.factor));
        let signal = factor.and_then(|own| signals.get(own.signal));
        match signal.and_then(|own| own.place_unit) {
            Some(unit) if at.which == 0 => unit.to_owned(),
            _ => signal.map_or_else(String::new, |own| {
                own.unit.text(self.fitted.prepared.facts.joint)
            }),
        }
    }

    /// The simplest of the best first; then those that are simpler or explain more.
    fn ranked(&self, judged: Vec<Judged>) -> Vec<Formula> {
        let Some(best) = judged.first() else {
            return Vec::new();
        };
        let first = (judged.iter().enumerate())
            .filter(|(_, own)| as_good(best, own))
            .min_by_key(|(at, own)| (own.formula.complexity, *at))
            .map_or(0, |(at, _)| at);
        let is_on_front = |at: usize| {
            let own = &judged[at].formula;
            at == first
                || judged.iter().enumerate().all(|(other_at, other)| {
                    let other = &other.formula;
                    other_at == at
                        || own.complexity < other.complexity
                        || own.held_out_after < CLEARLY_LESS * other.held_out_after
                })
        };
        let mut order: Vec<usize> = (0..judged.len()).filter(|at| is_on_front(*at)).collect();
        order.sort_by_key(|at| (*at != first, *at));
        order
            .into_iter()
            .map(|at| self.with_rivals(&judged, at))
            .collect()
    }

    /// A formula with what cannot be told from it, and what would decide.
    fn with_rivals(&self, judged: &[Judged], at: usize) -> Formula {
        let own = &judged[at];
        let others = judged.iter().enumerate();
        let rivals: Vec<&Judged> = others
            .filter(|(other, rival)| *other != at && (as_good(own, rival) && as_good(rival, own)))
            .map(|(_, rival)| rival)
            .take(MAX_RIVALS)
            .collect();
        let next_experiment = self.deciding(own, &rivals);
        let expressions = rivals.iter().map(|own| own.formula.expression.clone());
        Formula {
            cannot_be_told_from: expressions.collect(),
            separate_by: format!(
                "{}: {}",
                next_experiment.id(),
                next_experiment.instruction()
            ),
            next_experiment,
            ..own.formula.clone()
        }
    }

    /// The recording that varies what only one of two formulas reads, for as many of
    /// the rivals as one recording can; of formulas over the same signals what varies
    /// these most.
    fn deciding(&self, own: &Judged, rivals: &[&Judged]) -> Proposal {
        let mut votes: Vec<usize> = Vec::new();
        for rival in rivals {
            let only = |a: &[usize], b: &[usize]| -> Vec<usize> {
                a.iter()
                    .filter(|signal| !b.contains(signal))
                    .copied()
                    .collect()
            };
            let mut apart = only(&own.signals, &rival.signals);
            apart.extend(only(&rival.signals, &own.signals));
            votes.extend(if apart.is_empty() {
                own.signals.clone()
            } else {
                apart
            });
        }
        if votes.is_empty() {
            votes.clone_from(&own.signals);
        }
        let subject = self.fitted.prepared.facts.joint.subject();
        let varied = votes.iter().map(|signal| {
            let channel = self.rows.channels.get(*signal);
            let name = channel.map_or("", |own| own.signal.name.as_str());
            varied_by(subject, name)
        });
        let varied: Vec<Proposal> = varied.collect();
        let count = |proposal: &Proposal| varied.iter().filter(|own| *own == proposal).count();
        let all = Proposal::ALL.iter().rev();
        let most = all.max_by_key(|proposal| count(proposal));
        most.copied().unwrap_or(Proposal::LoadSteps)
    }
}

/// The recording that varies a signal of formulas most.
fn varied_by(subject: Subject, signal: &str) -> Proposal {
    match (subject, signal) {
        (_, "T") => Proposal::TemperatureSweep,
        (Subject::Joint, "t") => Proposal::DateSweep,
        (Subject::Contact, "t") => Proposal::ContactDates,
        (Subject::Joint, "q") => Proposal::WidePosition,
        (Subject::Joint, "qd") => Proposal::WideSpeedRange,
        (Subject::Joint, "tau") => Proposal::LoadSteps,
        (Subject::Joint, _) => Proposal::Accelerations,
        (Subject::Contact, "r") => Proposal::ContactSweep,
        (Subject::Contact, "F_N") => Proposal::ContactForces,
        (Subject::Contact, _) => Proposal::ContactSpeeds,
    }
}

/// Whether `other` explains rows left out as well as `best` does.
fn as_good(best: &Judged, other: &Judged) -> bool {
    let ratio = other.formula.held_out_after / best.formula.held_out_after.max(1e-300);
    let is_certain = || best.left_out.decrease_from(&other.left_out).is_certain();
    ratio < EQUAL || (ratio < NEARLY_EQUAL && !is_certain())
}

/// The signals that terms read, each once.
fn read_by(terms: &[FormulaTerm]) -> Vec<usize> {
    let mut all: Vec<usize> = terms.iter().flat_map(FormulaTerm::signals).collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// As many significant digits as a constant with this standard error is worth.
fn digits(value: f64, error: f64) -> usize {
    let enough = |digits: &usize| {
        let (_, number) = rounded(value, *digits);
        (number - value).abs() <= 0.2 * error
    };
    (2..5).find(enough).unwrap_or(5)
}
