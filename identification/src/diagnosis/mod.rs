//! Which effect is missing, if any.
//!
//! Every effect that the model lacks is a candidate (`candidates`). Of those that pass the tests
//! (`verdict`) and lower the error that is reported (`acceptance`), the simplest of the equivalent
//! ones comes first (`equivalents`), or what leaves clearly less of that error (`by_left_out`), after pairs that are easily confused have been decided: by the
//! rows at reversals, by the sensor's zero, by what large torques have in common
//! (`beyond_a_limit`), by an encompassing test (`examination`). What noise of the acceleration may
//! look like has to be there with a slower filter, too (`confirmation`). The same at other cut-offs
//! tells what the filter has to do with it (`other_cutoffs`).

mod acceptance;
mod at_reversals;
mod backlash_or_presliding;
mod beyond_a_limit;
mod by_left_out;
mod candidates;
pub(crate) mod confirmation;
pub mod dependence;
mod encompassing_test;
mod equivalents;
mod examination;
mod modelled_load;
mod not_tested;
mod other_cutoffs;
mod results;
mod sensor_zero;
mod verdict;

use std::collections::BTreeMap;

use crate::comparison::{noise_floor, usage, varies_together};
use crate::data::check::check;
use crate::data::error::PrepareError;
use crate::data::{Dataset, ModelSpec, RecordedSession};
use crate::design::{Design, PreparedModel};
use crate::fit::addition::Addition;
use crate::fit::{Parameter, Rms};
use crate::preparation::Filtered;

use candidates::{Candidate, Trial};
use examination::Examination;
pub use not_tested::NotTested;
pub use results::{Diagnosis, NamedCandidate, RunnerUp, Suspect, Verdict, VerdictAtCutoff, WhyNot};
use verdict::why_not;

/// Effects that are told as tried and not named, at most.
const MAX_RUNNERS_UP: usize = 5;
/// Other cut-offs at which the verdict is asked for, as factors.
const OTHER_CUTOFFS: [f64; 2] = [0.5, 1.5];

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
    let found = examination::examine(&filtered, spec, None, progress)?;
    progress(1.0);
    Ok(describe_all(dataset, &found))
}

/// The same, with the verdicts at two other cut-offs of the filter.
///
/// # Errors
///
/// See [`PrepareError`].
pub fn diagnose_at_cutoffs(
    dataset: &Dataset,
    spec: &ModelSpec,
    progress: &mut dyn FnMut(f64),
) -> Result<Diagnosis, PrepareError> {
    check(dataset, spec)?;
    let filtered = Filtered::new(dataset);
    let found = examination::examine(&filtered, spec, None, &mut |done| progress(0.7 * done))?;
    let mut diagnosis = describe_all(dataset, &found);
    for (number, factor) in OTHER_CUTOFFS.into_iter().enumerate() {
        let other = other_cutoffs::verdict(dataset, spec, &found.trial, factor, &diagnosis);
        diagnosis.verdict_at_other_cutoffs.push(other);
        progress(0.7 + 0.15 * (number as f64 + 1.0));
    }
    Ok(diagnosis)
}

/// What an examination found, in results.
fn describe_all(dataset: &Dataset, found: &Examination) -> Diagnosis {
    let Examination {
        prepared,
        design,
        trial,
        base,
        passing,
        additions,
        maps,
        verdict,
    } = found;
    let described: Vec<NamedCandidate> = (passing.iter())
        .filter_map(|candidate| {
            let addition = additions.get(candidate.id())?;
            Some(describe(
                prepared, design, addition, candidate, passing, trial,
            ))
        })
        .collect();
    // A residual that no effect explains is not reported under the name of a similar one.
    let (candidates, helps_in_part) = match verdict {
        Verdict::Missing => (described, Vec::new()),
        Verdict::Unexplained => (Vec::new(), described),
        Verdict::Complete => (Vec::new(), Vec::new()),
    };
    let suspected = match candidates.is_empty() {
        true => suspected(trial),
        false => Vec::new(),
    };
    // Gains by parameters of each session's own and by shared ones are shares of
    // different errors.
    let mut depends_on = maps.clone();
    depends_on.sort_by(|a, b| b.strength.total_cmp(&a.strength));
    let noise = noise_floor::find(prepared, design);
    Diagnosis {
        samples: dataset.sessions.iter().map(RecordedSession::len).sum(),
        used: usage::find(dataset, prepared, design),
        verdict: *verdict,
        rms: Rms {
            train: base.train,
            held_out: base.held_out,
        },
        noise_floor: noise.repeats,
        noise,
        candidates,
        suspected,
        helps_in_part,
        runners_up: runners_up(trial, passing),
        verdict_at_other_cutoffs: Vec::new(),
        soundness: base.soundness.clone(),
        varies_together: varies_together::find(dataset),
        residual_depends_on: depends_on,
        tried: trial.variants + trial.variants_between,
        not_tested: NotTested::of(prepared, prepared.coupling().is_some()),
    }
}

/// The strongest of those that were tried and do not pass.
fn runners_up(trial: &Trial, passing: &[Candidate]) -> Vec<RunnerUp> {
    let is_named = |own: &Candidate| passing.iter().any(|other| other.id() == own.id());
    let others = trial.candidates.iter().filter(|own| !is_named(own));
    others
        .take(MAX_RUNNERS_UP)
        .map(|own| RunnerUp {
            effect: own.id().to_owned(),
            share: own.score.share(),
            p_value: trial.corrected(own),
            why_not: why_not(own, trial),
        })
        .collect()
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
    let [share, share_std_error] = addition.decrease.share();
    NamedCandidate {
        effect: id.to_owned(),
        held_out_before: addition.held_out_before,
        held_out_after: addition.held_out_after,
        p_value: trial.corrected(candidate),
        share,
        share_std_error,
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
                parameter.shift(-given);
                (correction.name.to_owned(), parameter)
            }
            _ => (name.clone(), parameter),
        }
    })
    .collect()
}
