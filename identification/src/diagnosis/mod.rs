//! Which effect is missing, if any.
//!
//! Every effect that the model lacks is a candidate (`candidates`). Of those that
//! pass the tests (`verdict`) and lower the error that is reported (`acceptance`), the simplest of the equivalent ones comes first
//! (`equivalents`), after pairs that are easily confused have been decided: by the
//! rows at reversals, by the sensor's zero, by an encompassing test.

mod acceptance;
mod at_reversals;
mod backlash_or_presliding;
mod candidates;
pub mod dependence;
mod encompassing_test;
mod equivalents;
mod results;
mod sensor_zero;
mod verdict;

use std::collections::BTreeMap;

use crate::comparison::noise_floor;
use crate::data::check::check;
use crate::data::error::PrepareError;
use crate::data::{Dataset, ModelSpec, RecordedSession};
use crate::design::{Design, PreparedModel};
use crate::effects::COUPLING;
use crate::fit::addition::Addition;
use crate::fit::{Parameter, Rms, fit};
use crate::preparation::Filtered;

use acceptance::Acceptance;
use candidates::{Candidate, Trial, try_all};
use dependence::Dependence;
pub use results::{Diagnosis, NamedCandidate, Suspect, Verdict};
use verdict::{judge, maps, passing};

/// Smallest share of a map that passed which an effect must explain to be its name.
const MIN_SHARE_OF_NAMED_MAP: f64 = 0.85;

/// Tries every effect that the model lacks.
///
/// `progress` is called with the share done, 0 … 1.
///
/// # Errors
///
/// See [`PrepareError`].
pub fn diagnose(
    dataset: &Dataset,
    spec: &ModelSpec,
    progress: &mut dyn FnMut(f64),
) -> Result<Diagnosis, PrepareError> {
    check(dataset, spec)?;
    let filtered = Filtered::new(dataset);
    let prepared = filtered.bind(spec)?;
    let design = Design::new(&prepared);
    progress(0.05);
    let trial = try_all(&prepared, &design, &mut |done| progress(0.05 + 0.6 * done));
    let base = fit(&prepared, &design);
    let noise = noise_floor::find(&prepared, &design, base.held_out);
    let mut acceptance = Acceptance {
        filtered: &filtered,
        spec,
        prepared: &prepared,
        base: &base,
        made: BTreeMap::new(),
    };
    let mut passing = passing(&trial);
    acceptance.keep_accepted(&mut passing);
    encompassing_test::drop_redundant_terms(&prepared, &design, &mut passing);
    equivalents::order(&design, &mut passing);
    backlash_or_presliding::decide(&prepared, &mut passing, &trial.candidates);
    sensor_zero::decide(&prepared, &mut passing);
    encompassing_test::drop_encompassed(&prepared, &design, &mut passing);
    at_reversals::put_first(&prepared, &design, &mut passing);
    let maps = maps(&prepared, &design);
    if passing.is_empty() {
        passing.extend(named_by_map(&trial, &maps));
    }
    acceptance.keep_accepted(&mut passing);
    progress(0.75);
    let verdict = judge(&prepared, &passing, &maps, &mut |done| {
        progress(0.75 + 0.2 * done)
    });
    // A residual that no effect explains is not reported under the name of a similar one.
    let named: &[Candidate] = if verdict == Verdict::Missing {
        &passing
    } else {
        &[]
    };
    let suspected = match named.is_empty() {
        true => suspected(&trial),
        false => Vec::new(),
    };
    let candidates = named
        .iter()
        .filter_map(|candidate| {
            let addition = acceptance.of(candidate)?;
            Some(describe(
                &prepared, &design, addition, candidate, &passing, &trial,
            ))
        })
        .collect();
    // Gains by parameters of each session's own and by shared ones are shares of
    // different errors.
    let mut depends_on = maps;
    depends_on.sort_by(|a, b| b.strength.total_cmp(&a.strength));
    progress(1.0);
    Ok(Diagnosis {
        samples: dataset.sessions.iter().map(RecordedSession::len).sum(),
        used: design.total().rows,
        verdict,
        rms: Rms {
            train: base.train,
            held_out: base.held_out,
        },
        noise_floor: noise.repeats,
        noise,
        candidates,
        suspected,
        residual_depends_on: depends_on,
        tried: trial.variants + trial.variants_between,
        not_tested: match prepared.coupling().is_some() || dataset.joint.is_contact() {
            true => Vec::new(),
            false => vec![COUPLING.to_owned()],
        },
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

/// Effects that show between sessions, for a diagnosis in which nothing passes.
fn suspected(trial: &Trial) -> Vec<Suspect> {
    equivalents::suspects(&trial.candidates)
        .map(|candidate| Suspect {
            effect: candidate.id().to_owned(),
            p_value: candidate.score.p_value,
            share: candidate.score.share(),
            next_experiment: equivalents::proposal(candidate, &[]),
        })
        .collect()
}

/// A candidate with its parameters and errors in the model, and its equivalents.
fn describe(
    prepared: &PreparedModel,
    design: &Design,
    addition: &Addition,
    candidate: &Candidate,
    passing: &[Candidate],
    trial: &Trial,
) -> NamedCandidate {
    let id = candidate.id();
    let equivalents = equivalents::find(design, candidate, passing, &trial.candidates);
    let decrease = &addition.decrease;
    NamedCandidate {
        effect: id.to_owned(),
        held_out_before: addition.held_out_before,
        held_out_after: addition.held_out_after,
        p_value: trial.corrected(candidate),
        share: decrease.mean_square / decrease.before.powi(2).max(1e-300),
        share_std_error: decrease.std_error / decrease.before.powi(2).max(1e-300),
        parameters: parameters(prepared, addition, candidate),
        separate_by: equivalents::separate_by(prepared, candidate, &equivalents),
        next_experiment: equivalents::proposal(candidate, &equivalents),
        indistinguishable_from: equivalents.iter().map(|c| c.id().to_owned()).collect(),
    }
}

/// The candidate's own parameters in the model with it.
fn parameters(
    prepared: &PreparedModel,
    addition: &Addition,
    candidate: &Candidate,
) -> BTreeMap<String, Parameter> {
    let row = candidate.effect.row();
    let all = addition.parameters.iter();
    let own = all.filter(|(_, parameter)| parameter.effect == candidate.id());
    own.map(|(name, parameter)| {
        let mut parameter = parameter.clone();
        // The inertia is fitted as a whole; what is missing is a correction.
        match (
            row.corrects_inertia,
            row.coefficients,
            prepared.facts.inertia,
        ) {
            (true, [correction], Some(given)) => {
                parameter.value -= given;
                (correction.name.to_owned(), parameter)
            }
            _ => (name.clone(), parameter),
        }
    })
    .collect()
}
