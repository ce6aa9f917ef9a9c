//! A model put to all tests, with one filter.

use std::collections::BTreeMap;

use super::acceptance::Acceptance;
use super::candidates::{Candidate, Trial, try_again, try_all};
use super::confirmation::Confirmation;
use super::dependence::{self, Dependence};
use super::results::Verdict;
use super::verdict::{judge, maps, passing};
use super::{
    at_reversals, backlash_or_presliding, beyond_a_limit, by_left_out, encompassing_test,
    equivalents, modelled_load, sensor_zero,
};
use crate::data::ModelSpec;
use crate::data::error::PrepareError;
use crate::design::{Design, PreparedModel};
use crate::fit::addition::Addition;
use crate::fit::{Fit, fit};
use crate::preparation::Filtered;

/// Smallest share of a map that passed which an effect must explain to be its name.
const MIN_SHARE_OF_NAMED_MAP: f64 = 0.85;

/// What came of it.
pub(super) struct Examination {
    pub(super) prepared: PreparedModel,
    pub(super) design: Design,
    /// Every effect that the model lacks, at its best shape.
    pub(super) trial: Trial,
    /// The model as it is.
    pub(super) base: Fit,
    /// Those that pass all tests and lower the error, best first.
    pub(super) passing: Vec<Candidate>,
    /// The model with each of them, by their ids.
    pub(super) additions: BTreeMap<String, Addition>,
    /// Dependences of the residual; where it goes with no signal, that on its own past, which tells
    /// for no name and against none.
    pub(super) maps: Vec<Dependence>,
    pub(super) verdict: Verdict,
}

/// Puts the model to all tests; where there is a trial with another filter, at the
/// shapes found there. `progress` is called with the share done, 0 … 1.
pub(super) fn examine(
    filtered: &Filtered<'_>,
    spec: &ModelSpec,
    known: Option<&Trial>,
    progress: &mut dyn FnMut(f64),
) -> Result<Examination, PrepareError> {
    let prepared = filtered.bind(spec)?;
    let design = Design::new(&prepared);
    progress(0.05);
    let trial = match known {
        Some(known) => try_again(&prepared, &design, known),
        None => try_all(&prepared, &design, &mut |done| progress(0.05 + 0.6 * done)),
    };
    let base = fit(&prepared, &design);
    let mut acceptance = Acceptance {
        filtered,
        spec,
        prepared: &prepared,
        base: &base,
        keeps_shapes: known.is_some(),
        made: BTreeMap::new(),
    };
    let mut passing = passing(&trial);
    acceptance.keep_accepted(&mut passing);
    encompassing_test::drop_redundant_terms(&prepared, &design, &mut passing);
    modelled_load::drop_pulls(&prepared, &design, &mut passing, &trial.candidates);
    equivalents::order(&design, &mut passing);
    by_left_out::put_first(&acceptance.made, &mut passing);
    beyond_a_limit::put_behind(&prepared, &design, &mut passing);
    modelled_load::put_first(&prepared, &design, &mut passing);
    backlash_or_presliding::decide(&prepared, &mut passing, &trial.candidates);
    sensor_zero::decide(&prepared, &mut passing);
    encompassing_test::drop_encompassed(&prepared, &design, &mut passing);
    at_reversals::put_first(&prepared, &design, &mut passing, &trial.candidates);
    let mut maps = maps(&prepared, &design);
    let confirmation = match known.is_some() || filtered.is_contact() {
        true => Confirmation::NONE,
        false => Confirmation::of(filtered, spec, &prepared, &trial, &passing, &maps),
    };
    confirmation.keep(&mut passing);
    maps.retain(|own| confirmation.has_map(own));
    if passing.is_empty() {
        passing.extend(named_by_map(&trial, &maps));
    }
    acceptance.keep_accepted(&mut passing);
    progress(0.75);
    let mut tell = |done| progress(0.75 + 0.2 * done);
    let mut verdict = judge(
        &prepared,
        &design,
        &passing,
        &maps,
        &confirmation,
        &mut tell,
    );
    if maps.is_empty() {
        maps.extend(dependence::on_own_past(&prepared, &design));
    }
    if verdict == Verdict::Complete && !maps.is_empty() {
        verdict = Verdict::Unexplained;
    }
    let made = acceptance.made.into_iter();
    let additions = made.filter_map(|(id, addition)| Some((id, addition?)));
    let additions = additions.collect();
    Ok(Examination {
        prepared,
        design,
        trial,
        base,
        passing,
        additions,
        maps,
        verdict,
    })
}

/// The suspect that explains as much as a map over its own signals, with the map's
/// p-value. A free map has many coefficients, so that fewer sessions make it
/// significant than the one coefficient of an effect.
fn named_by_map(trial: &Trial, maps: &[Dependence]) -> Option<Candidate> {
    let best = equivalents::suspects(&trial.candidates).next()?;
    let names = best.effect.row().own_signals.names;
    let map = maps.iter().find(|map| {
        let own = |signal: &String| names.contains(&signal.as_str());
        map.signals.iter().any(own) && best.score.gain > MIN_SHARE_OF_NAMED_MAP * map.gain
    })?;
    let mut named = best.clone();
    named.score.p_value = map.p_value / trial.variants_between.max(1) as f64;
    Some(named)
}
