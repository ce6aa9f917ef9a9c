//! The search: terms added one after the other and multiplied by one more function,
//! a few of the best kept at every step, until chance does as well.

use super::constants::polish;
use super::dictionary::{Dictionary, factors_in_products};
use super::rows::{Rows, dot, extend_basis, square, take_out};
use super::significance::Chance;
use super::state::State;
use super::term::Term;

/// Largest p-value of a term.
pub(super) const SIGNIFICANCE: f64 = 0.01;
/// Terms of a formula, at most, …
const MAX_TERMS: usize = 3;
/// … and factors of a term.
const MAX_FACTORS: usize = 3;
/// Formulas that are kept at a step, …
const KEPT: usize = 4;
/// … and terms that each of them is continued with: of no formula yet, …
const FIRST: usize = 12;
/// … and of one; of one pair of signals not more than the last.
const NEXT: usize = 4;
const OF_SAME_SIGNALS: usize = 3;
/// A column of which the terms before it explain all but this share tells nothing new.
const MIN_OWN_SHARE: f64 = 0.02;
/// Terms that gain less than this share of what the best gains are not tried.
const MIN_SHARE_OF_BEST: f64 = 0.3;

/// What every term of the dictionary gains beside the terms of `state`, and what
/// chance gains there.
fn gains(rows: &Rows, dictionary: &Dictionary, state: &State, seed: u64) -> (Vec<f64>, Chance) {
    let single = |of: &[f64]| -> Vec<f32> { of.iter().map(|x| *x as f32).collect() };
    let residual = single(&state.residual);
    let basis: Vec<Vec<f32>> = state.basis.iter().map(|own| single(own)).collect();
    let product = |a: &[f32], b: &[f32]| -> f32 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let blocks = rows.blocks.len();
    let within = |column: &[f32], of: &[f32], (from, to): (usize, usize)| {
        let range = |all: &[f32]| all.get(from..to).unwrap_or_default().to_vec();
        product(&range(column), &range(of))
    };
    let of_basis: Vec<Vec<f32>> = (basis.iter())
        .map(|own| {
            let each = rows.blocks.iter();
            each.map(|block| within(own, &residual, *block)).collect()
        })
        .collect();
    let mut products = Vec::with_capacity(dictionary.terms.len() * blocks);
    let mut gains = Vec::with_capacity(dictionary.terms.len());
    for at in 0..dictionary.terms.len() {
        let column = dictionary.column(at);
        let along: Vec<f32> = basis.iter().map(|own| product(own, column)).collect();
        let own: f32 = 1.0 - along.iter().map(|x| x * x).sum::<f32>();
        let scale = match f64::from(own) > MIN_OWN_SHARE {
            true => own.sqrt().recip(),
            false => 0.0,
        };
        let mut sum = 0.0;
        for (number, (from, to)) in rows.blocks.iter().enumerate() {
            let mut here = product(&column[*from..*to], &residual[*from..*to]);
            for (along, of_basis) in along.iter().zip(&of_basis) {
                here -= along * of_basis[number];
            }
            here *= scale;
            sum += here;
            products.push(here);
        }
        gains.push(f64::from(sum * sum));
    }
    (gains, Chance::new(&products, blocks, seed))
}

/// The terms that `state` is continued with, best first, with their p-values.
fn choose(
    dictionary: &Dictionary,
    gains: &[f64],
    chance: &Chance,
    most: usize,
) -> Vec<(Term, f64)> {
    let mut order: Vec<usize> = (0..gains.len()).collect();
    order.sort_by(|a, b| gains[*b].total_cmp(&gains[*a]).then(a.cmp(b)));
    let best = order.first().map_or(0.0, |at| gains[*at]);
    let mut chosen: Vec<(Term, f64)> = Vec::new();
    for at in order {
        let p_value = chance.p_value(gains[at]);
        if chosen.len() >= most || p_value > SIGNIFICANCE || gains[at] < MIN_SHARE_OF_BEST * best {
            break;
        }
        let term = &dictionary.terms[at];
        let signals = |term: &Term| {
            let mut all: Vec<usize> = term.signals().collect();
            all.sort_unstable();
            all.dedup();
            all
        };
        let same_structure = chosen
            .iter()
            .any(|(own, _)| own.structure() == term.structure());
        let same_signals = chosen.iter();
        let same_signals = same_signals.filter(|(own, _)| signals(own) == signals(term));
        if !same_structure && same_signals.count() < OF_SAME_SIGNALS {
            chosen.push((term.clone(), p_value));
        }
    }
    chosen
}

/// `state` with one of its terms multiplied by a function of a signal that the term
/// does not read, where that explains more than a further term does by chance.
fn multiplied(rows: &Rows, state: &State, chance: &Chance) -> Option<State> {
    let factors = factors_in_products(rows);
    let mut best: Option<(f64, Vec<Term>)> = None;
    for (at, term) in state.terms.iter().enumerate() {
        if term.factors.len() >= MAX_FACTORS {
            continue;
        }
        let mut others = Vec::new();
        for (_, other) in (state.terms.iter().enumerate()).filter(|(own, _)| *own != at) {
            extend_basis(&mut others, rows.column_of(other)?);
        }
        let mut residual = rows.residual.clone();
        take_out(&others, &mut residual);
        let mut samples: Vec<Vec<f64>> = term.factors.iter().map(|own| rows.factor(own)).collect();
        if term.direction {
            samples.push(rows.direction());
        }
        for factor in &factors {
            if term.factors.iter().any(|own| own.signal == factor.signal) {
                continue;
            }
            let new = rows.factor(factor);
            let views: Vec<&[f64]> = samples.iter().map(Vec::as_slice).chain([&*new]).collect();
            let Some(mut column) = rows.column(&views) else {
                continue;
            };
            take_out(&others, &mut column);
            let error =
                square(&residual) - dot(&column, &residual).powi(2) / square(&column).max(1e-300);
            if best.as_ref().is_none_or(|(least, _)| error < *least) {
                let mut terms = state.terms.clone();
                if let Some(own) = terms.get_mut(at) {
                    own.factors.push(*factor);
                    own.factors.sort_by_key(|own| own.signal);
                }
                best = Some((error, terms));
            }
        }
    }
    let (error, terms) = best?;
    let p_value = chance.p_value(state.error - error);
    if p_value > SIGNIFICANCE {
        return None;
    }
    polish(rows, &State::of(rows, terms, state.p_value.max(p_value))?)
}

/// Every formula that was kept on the way, none whose terms chance explains.
/// `progress` is called with the share done, 0 … 1.
pub(super) fn search(
    rows: &Rows,
    dictionary: &Dictionary,
    seed: u64,
    progress: &mut dyn FnMut(f64),
) -> Vec<State> {
    let mut found: Vec<State> = Vec::new();
    let mut beam = vec![State::empty(rows)];
    for step in 0..MAX_TERMS {
        let mut next: Vec<State> = Vec::new();
        let most = if step == 0 { FIRST } else { NEXT };
        let count = beam.len();
        for (number, state) in beam.iter().enumerate() {
            let (gains, chance) = gains(rows, dictionary, state, seed);
            let chosen = choose(dictionary, &gains, &chance, most);
            let parts = chosen.len() + 1;
            for (part, (term, p_value)) in chosen.into_iter().enumerate() {
                let mut terms = state.terms.clone();
                terms.push(term);
                let state = State::of(rows, terms, state.p_value.max(p_value));
                next.extend(state.and_then(|state| polish(rows, &state)));
                let done = (number as f64 + (part + 1) as f64 / parts as f64) / count as f64;
                progress((step as f64 + done) / MAX_TERMS as f64);
            }
            next.extend(multiplied(rows, state, &chance));
        }
        next.sort_by(|a, b| a.error.total_cmp(&b.error));
        keep_one_of_each(&mut next);
        found.extend(next.iter().cloned());
        next.truncate(KEPT);
        if next.is_empty() {
            break;
        }
        beam = next;
    }
    found.extend(pruned(rows, &found));
    found.sort_by(|a, b| a.error.total_cmp(&b.error));
    keep_one_of_each(&mut found);
    progress(1.0);
    found
}

/// The best formulas less one term each: what came first may be explained by what
/// came later.
fn pruned(rows: &Rows, found: &[State]) -> Vec<State> {
    let mut with_several: Vec<&State> = found.iter().filter(|own| own.terms.len() > 1).collect();
    with_several.sort_by(|a, b| a.error.total_cmp(&b.error));
    let mut all = Vec::new();
    for state in with_several.into_iter().take(2) {
        for left_out in 0..state.terms.len() {
            let mut terms = state.terms.clone();
            terms.remove(left_out);
            let state = State::of(rows, terms, state.p_value);
            all.extend(state.and_then(|state| polish(rows, &state)));
        }
    }
    all
}

/// Of formulas that differ in numbers only the first.
fn keep_one_of_each(states: &mut Vec<State>) {
    let mut seen = Vec::new();
    states.retain(|state| {
        let structure = state.structure();
        let is_new = !seen.contains(&structure);
        seen.push(structure);
        is_new
    });
}
