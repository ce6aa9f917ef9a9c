//! Places and scales within a formula: searched by golden sections, and their
//! standard errors.

use nalgebra::DVector;

use super::dictionary::bounds;
use super::rows::{Rows, dot, extend_basis, square, take_out};
use super::state::State;
use super::term::{At, Term, constant, constants, set};
use crate::numerics::gram::Gram;
use crate::numerics::statistics::jackknife_covariance;
use crate::shape_search::golden_section;

/// Rounds over all constants, at most, …
const MAX_ROUNDS: usize = 4;
/// … and no more after one that leaves a larger share of the error than this.
const MAX_REMAINING_SHARE: f64 = 0.999;
/// Factor to either side within which a scale is searched in the first round …
const SCALE_SPAN: f64 = 2.5;
/// … and share of the bounds' distance, of a place.
const PLACE_SPAN: f64 = 0.12;
/// Step of a derivative, as a share of a scale or of the bounds' distance.
const STEP: f64 = 1e-3;
/// Sessions from which errors are by sessions left out.
const MIN_SESSIONS: usize = 3;

/// The same terms with the constants that leave the least error.
pub(super) fn polish(rows: &Rows, state: &State) -> Option<State> {
    let mut terms = state.terms.clone();
    let all = constants(&terms);
    if all.is_empty() {
        return Some(state.clone());
    }
    let mut error = state.error;
    for round in 0..MAX_ROUNDS {
        let before = error;
        let narrower = 0.5_f64.powi(round as i32);
        for at in &all {
            error = refine(rows, &mut terms, *at, error, narrower)?;
        }
        if error > MAX_REMAINING_SHARE * before {
            break;
        }
    }
    State::of(rows, terms, state.p_value)
}

/// Refines one constant; the error that is left then.
fn refine(rows: &Rows, terms: &mut [Term], at: At, error: f64, narrower: f64) -> Option<f64> {
    let mut others = Vec::new();
    for (_, other) in (terms.iter().enumerate()).filter(|(own, _)| *own != at.term) {
        extend_basis(&mut others, rows.column_of(other)?);
    }
    let mut residual = rows.residual.clone();
    take_out(&others, &mut residual);
    let whole = square(&residual);
    let term = terms.get(at.term)?.clone();
    let factor = term.factors.get(at.factor)?;
    let mut fixed: Vec<Vec<f64>> = (term.factors.iter().enumerate())
        .filter(|(number, _)| *number != at.factor)
        .map(|(_, own)| rows.factor(own))
        .collect();
    if term.direction {
        fixed.push(rows.direction());
    }
    let value = constant(terms, at);
    let [low, high] = bounds(rows.channels.get(factor.signal)?, at.which, value);
    // A scale is searched by ratio, with its sign.
    let sign = if at.which == 1 && value < 0.0 {
        -1.0
    } else {
        1.0
    };
    let is_scale = at.which == 1;
    let to = |x: f64| if is_scale { x.abs().ln() } else { x };
    let from = |x: f64| if is_scale { x.exp() } else { x };
    let span = match at.which {
        1 => SCALE_SPAN.ln() * narrower,
        _ => PLACE_SPAN * (high - low) * narrower,
    };
    let (a, b) = (to(low).min(to(high)), to(low).max(to(high)));
    let mut shape = [to(value).clamp(a, b)];
    let range = [(shape[0] - span).max(a), (shape[0] + span).min(b)];
    if range[1] <= range[0] {
        return Some(error);
    }
    let mut own = *factor;
    let found = golden_section(&mut shape, 0, range, error, |shape| {
        own.constants[at.which] = sign * from(shape[0]);
        let samples = rows.factor(&own);
        let views: Vec<&[f64]> = fixed.iter().map(Vec::as_slice).chain([&*samples]).collect();
        let Some(mut column) = rows.column(&views) else {
            return f64::INFINITY;
        };
        take_out(&others, &mut column);
        whole - dot(&column, &residual).powi(2) / square(&column).max(1e-300)
    });
    if found < error {
        set(terms, at, sign * from(shape[0]));
    }
    Some(found)
}

/// Standard errors of the coefficients, then of the other constants, all of them fitted
/// together: by sessions left out in turn where there are three or more, else by
/// blocks of time.
pub(super) fn errors(rows: &Rows, terms: &[Term]) -> Option<Vec<f64>> {
    let mut columns: Vec<Vec<f64>> = Vec::new();
    for term in terms {
        columns.push(rows.column_of(term)?);
    }
    let of = |columns: &[Vec<f64>], from: usize, to: usize| {
        let views: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
        Gram::from_columns(&views, &rows.residual, from, to)
    };
    let coefficients = of(&columns, 0, rows.count()).solve();
    for at in constants(terms) {
        let term = terms.get(at.term)?;
        let channel = rows.channels.get(term.factors.get(at.factor)?.signal)?;
        let value = constant(terms, at);
        let [low, high] = bounds(channel, at.which, value);
        let step = match at.which {
            1 => STEP * value.abs(),
            _ => STEP * (high - low),
        };
        let moved = |by: f64| {
            let mut terms = terms.to_vec();
            set(&mut terms, at, value + by);
            terms.get(at.term).and_then(|term| rows.column_of(term))
        };
        let (above, below) = (moved(step)?, moved(-step)?);
        let slope = coefficients.get(at.term)? / (2.0 * step);
        let both = above.iter().zip(&below);
        columns.push(both.map(|(above, below)| slope * (above - below)).collect());
    }
    let blocks: Vec<Gram> = (rows.blocks.iter())
        .map(|(from, to)| of(&columns, *from, *to))
        .collect();
    let count = columns.len();
    let sessions = rows.session_of.last().map_or(0, |last| last + 1);
    let clusters: Vec<Gram> = match sessions >= MIN_SESSIONS {
        true => (0..sessions)
            .map(|session| {
                let own = blocks.iter().zip(&rows.session_of);
                let own = own.filter(|(_, of)| **of == session);
                Gram::sum(own.map(|(gram, _)| gram), count)
            })
            .filter(|gram| gram.rows > 0)
            .collect(),
        false => blocks.clone(),
    };
    let total = Gram::sum(&blocks, count);
    let estimate = total.solve();
    let without: Vec<DVector<f64>> = clusters
        .iter()
        .map(|own| total.without(own).solve())
        .collect();
    let covariance = jackknife_covariance(&estimate, &without);
    Some(
        (0..count)
            .map(|at| covariance[(at, at)].max(0.0).sqrt())
            .collect(),
    )
}
