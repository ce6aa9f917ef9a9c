//! Which effect is missing, if any.
//!
//! Every effect that the model lacks is a candidate (`candidates`). Of those that
//! pass the tests (`verdict`), the simplest of the equivalent ones comes first
//! (`equivalents`), after pairs that are easily confused have been decided: by the
//! rows at reversals, by the sensor's zero, by an encompassing test.

mod at_reversals;
mod backlash_or_presliding;
mod candidates;
pub mod dependence;
mod encompassing_test;
mod equivalents;
mod results;
mod sensor_zero;
mod verdict;

use crate::comparison::noise_floor;
use crate::data::error::PrepareError;
use crate::data::{Dataset, ModelSpec, RecordedSession};
use crate::design::{Design, PreparedModel};
use crate::fit::{Fit, Rms, fit};
use crate::preparation::{extend, prepare};

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
    let prepared = prepare(dataset, spec)?;
    let design = Design::new(&prepared);
    progress(0.05);
    let trial = try_all(&prepared, &design, &mut |done| progress(0.05 + 0.6 * done));
    let base = fit(&prepared, &design);
    let noise = noise_floor::find(&prepared, &design, base.held_out * base.held_out);
    let mut passing = passing(&trial);
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
        .map(|candidate| describe(&prepared, &design, &base, candidate, &passing, &trial))
        .collect();
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
        residual_depends_on: maps,
        tried: trial.variants + trial.variants_between,
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
    base: &Fit,
    candidate: &Candidate,
    passing: &[Candidate],
    trial: &Trial,
) -> NamedCandidate {
    let term = candidate.term();
    // Before and after are reported on the rows that a model with it is fitted to.
    let extended = match candidate.effect.row().shows_at_reversals {
        true => extend(&prepared.with_reversals(), term),
        false => extend(prepared, term),
    };
    let before = match extended.rows().eq(prepared.rows()) {
        true => base.held_out,
        false => {
            let same = prepared.clone().on_rows_of(&extended);
            fit(&same, &Design::new(&same)).held_out
        }
    };
    let after = fit(&extended, &Design::new(&extended));
    let id = candidate.id();
    let equivalents = equivalents::find(design, candidate, passing, &trial.candidates);
    NamedCandidate {
        effect: id.to_owned(),
        held_out_before: before,
        held_out_after: after.held_out,
        p_value: trial.corrected(candidate),
        share: candidate.score.share(),
        parameters: after
            .parameters
            .into_iter()
            .filter(|(_, p)| p.effect == id)
            .collect(),
        separate_by: equivalents::separate_by(prepared, candidate, &equivalents),
        next_experiment: equivalents::proposal(candidate, &equivalents),
        indistinguishable_from: equivalents.iter().map(|c| c.id().to_owned()).collect(),
    }
}
