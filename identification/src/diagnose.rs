//! Which effect is missing, if any.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::candidates::{Candidate, Trial, try_all};
use crate::data::{Dataset, ModelSpec};
use crate::dependence::{self, Dependence};
use crate::design::Design;
use crate::encompass;
use crate::error::PrepareError;
use crate::family;
use crate::fit::{Fit, Parameter, fit};
use crate::noise_floor::{self, NoiseFloor};
use crate::reversal;
use crate::sensor_zero;
use crate::setup::{BoundTerm, Setup};
use crate::turns;
use ferntast_model::friction::Proposal;

/// A named effect explains this share of the mean square at least.
const LEAST_SHARE: f64 = 0.01;
/// Standard errors by which its prediction of rows left out is right.
const LEAST_CERTAINTY: f64 = 3.0;
/// Chance of a false alarm over all variants tried that show within a session …
const SIGNIFICANCE: f64 = 0.01;
/// … and over those that show between sessions, of which there are few.
const SIGNIFICANCE_BETWEEN: f64 = 0.012;
/// What has the shape of a map that passed explains this share of it at least.
const SAME_AS_MAP: f64 = 0.85;
/// A free map counts where it explains this share.
const LEAST_MAP_SHARE: f64 = 0.03;
/// If a free map over a named effect's own signals still explains this share of
/// what both explain, its shape is not the right one.
const WRONG_SHAPE: f64 = 0.13;
/// If free maps explain this share of what name and map explain together, the
/// name is at most a part of the answer …
const UNNAMED_SHARE: f64 = 0.45;
/// … and so it is if they explain this share,
const UNNAMED_NOTABLE: f64 = 0.12;
/// and with it this share of all that the name leaves.
const UNNAMED_OF_REST: f64 = 0.6;
/// A name that leaves out more than this of what a map over one signal explains
/// has not got its shape.
const LEAST_OF_MAP: f64 = 0.92;
/// Effects named on top of each other before giving up.
const MAX_EFFECTS: usize = 3;

/// What the recordings say.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// An effect of the catalogue is missing.
    Missing,
    /// What is left is noise.
    Complete,
    /// Something is missing that the catalogue does not have.
    Unexplained,
}

/// Root mean square errors \[Nm\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Rms {
    /// On the rows fitted.
    pub train: f64,
    /// On rows left out.
    pub held_out: f64,
}

/// An effect that passes all tests.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NamedCandidate {
    /// Its id.
    pub effect: String,
    /// RMS on rows left out without it \[Nm\].
    pub held_out_before: f64,
    /// With it \[Nm\].
    pub held_out_after: f64,
    /// p-value by leaving blocks out in turn, or by scatter between sessions, corrected
    /// for all variants tried.
    pub p_value: f64,
    /// Share of the residual's mean square that it explains on rows left out.
    pub share: f64,
    /// Its parameters.
    pub parameters: BTreeMap<String, Parameter>,
    /// Effects that explain these data as well.
    pub indistinguishable_from: Vec<String>,
    /// Motion or condition that would tell them apart, or confirm the one: the
    /// id of `next_experiment`, and what it is.
    pub separate_by: String,
    /// What to record next.
    pub next_experiment: Proposal,
}

/// An effect that may be there, but is not proven.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Suspect {
    /// Its id.
    pub effect: String,
    /// p-value by scatter between sessions, not corrected for what was tried.
    pub p_value: f64,
    /// Share of the residual's mean square that it explains on rows left out.
    pub share: f64,
    /// What to record to be sure.
    pub next_experiment: Proposal,
}

/// The answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Diagnosis {
    /// Samples in the recordings.
    pub samples: usize,
    /// Rows of the regression: filtered, thinned, away from rest.
    pub used: usize,
    /// The verdict.
    pub verdict: Verdict,
    /// Error of the model as it is.
    pub rms: Rms,
    /// RMS between repeats \[Nm\], where anything was repeated.
    pub noise_floor: Option<f64>,
    /// Both levels of noise.
    pub noise: NoiseFloor,
    /// Best first; only such as pass.
    pub candidates: Vec<NamedCandidate>,
    /// Where nothing passes: effects that show between sessions, for which these
    /// are too few to tell them from scatter. Best first.
    pub suspected: Vec<Suspect>,
    /// What the residual depends on, strongest first.
    pub residual_depends_on: Vec<Dependence>,
    /// Variants tried.
    pub tried: usize,
}

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
    let setup = Setup::new(dataset, spec)?;
    let design = Design::new(&setup);
    progress(0.05);
    let trial = try_all(&setup, &design, &mut |done| progress(0.05 + 0.6 * done));
    let base = fit(&setup, &design);
    let noise = noise_floor::find(&setup, &design, base.held_out * base.held_out);
    let mut passing = passing(&trial);
    encompass::without_idle_terms(&setup, &design, &mut passing);
    family::order(&design, &mut passing);
    reversal::settle(&setup, &mut passing, &trial.candidates);
    sensor_zero::settle(&setup, &mut passing);
    encompass::settle(&setup, &design, &mut passing);
    turns::settle(&setup, &design, &mut passing);
    let maps = maps(&setup, &design);
    if passing.is_empty() {
        passing.extend(named_by_map(&trial, &maps));
    }
    progress(0.75);
    let verdict = judge(&setup, &passing, &maps, &mut |done| {
        progress(0.75 + 0.2 * done)
    });
    // What has no name is not given the name of what resembles it.
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
        .map(|candidate| describe(&setup, &design, &base, candidate, &passing, &trial))
        .collect();
    progress(1.0);
    Ok(Diagnosis {
        samples: dataset.sessions.iter().map(crate::data::Session::len).sum(),
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

/// Candidates that pass every test, best first.
fn passing(trial: &Trial) -> Vec<Candidate> {
    trial
        .candidates
        .iter()
        .filter(|c| passes(c, trial))
        .cloned()
        .collect()
}

fn passes(candidate: &Candidate, trial: &Trial) -> bool {
    candidate.plausible
        && candidate.score.share() > LEAST_SHARE
        && (candidate.score.certainty > LEAST_CERTAINTY
            || candidate.effect.row().is_between_sessions())
        && trial.corrected(candidate)
            < match candidate.effect.row().is_between_sessions() {
                true => SIGNIFICANCE_BETWEEN,
                false => SIGNIFICANCE,
            }
}

/// A free map has many coefficients, and few sessions prove it sooner than the
/// one coefficient of an effect. What explains as much as a map over its own
/// signal is the map's name, and as certain.
fn named_by_map(trial: &Trial, maps: &[Dependence]) -> Option<Candidate> {
    let best = family::suspects(&trial.candidates).next()?;
    let names = best.effect.row().own_signals.names;
    let map = maps.iter().find(|map| {
        let own = |signal: &String| names.contains(&signal.as_str());
        map.signals.iter().any(own) && best.score.gain > SAME_AS_MAP * map.gain
    })?;
    let mut named = best.clone();
    named.score.p_value = map.p_value / trial.variants_between.max(1) as f64;
    Some(named)
}

fn suspected(trial: &Trial) -> Vec<Suspect> {
    family::suspects(&trial.candidates)
        .map(|candidate| Suspect {
            effect: candidate.id().to_owned(),
            p_value: candidate.score.p_value,
            share: candidate.score.share(),
            next_experiment: family::proposal(candidate, &[]),
        })
        .collect()
}

fn maps(setup: &Setup, design: &Design) -> Vec<Dependence> {
    let mut maps = dependence::find(setup, design);
    maps.retain(|d| d.strength > LEAST_MAP_SHARE);
    maps
}

/// Whether the best candidate is the answer: its shape must be right over its
/// own signals, and it (with others named on top of it) must explain more than
/// what has no name.
fn judge(
    setup: &Setup,
    passing_first: &[Candidate],
    maps_first: &[Dependence],
    progress: &mut dyn FnMut(f64),
) -> Verdict {
    let Some(first) = passing_first.first() else {
        return if maps_first.is_empty() {
            Verdict::Complete
        } else {
            Verdict::Unexplained
        };
    };
    let most_by_one = maps_first
        .iter()
        .filter(|map| map.signals.len() == 1)
        .fold(0.0, |most, map| f64::max(most, map.gain));
    let mut named = 0.0;
    let mut best = first.clone();
    let mut setup = setup.extended(BoundTerm::new(best.effect.clone(), best.shape.clone()));
    for step in 0..MAX_EFFECTS {
        let design = Design::new(&setup);
        let own = dependence::on_own_signals(&setup, &design, &best.effect);
        if own > WRONG_SHAPE * (own + best.score.gain) {
            break;
        }
        named += best.score.gain;
        let (unnamed, of_rest) = maps(&setup, &design)
            .first()
            .map_or((0.0, 0.0), |d| (d.gain, d.strength));
        let share = unnamed / (unnamed + named).max(1e-300);
        progress((step as f64 + 1.0) / MAX_EFFECTS as f64);
        let notable = share > UNNAMED_NOTABLE && of_rest > UNNAMED_OF_REST;
        let has_shape = named >= LEAST_OF_MAP * most_by_one;
        if share <= UNNAMED_SHARE && !notable && has_shape {
            return Verdict::Missing;
        }
        let trial = try_all(&setup, &design, &mut |_| ());
        let mut next = passing(&trial);
        family::order(&design, &mut next);
        let Some(candidate) = next.into_iter().next() else {
            break;
        };
        best = candidate;
        setup = setup.extended(BoundTerm::new(best.effect.clone(), best.shape.clone()));
    }
    Verdict::Unexplained
}

fn describe(
    setup: &Setup,
    design: &Design,
    base: &Fit,
    candidate: &Candidate,
    passing: &[Candidate],
    trial: &Trial,
) -> NamedCandidate {
    let term = BoundTerm::new(candidate.effect.clone(), candidate.shape.clone());
    // Before and after are reported on the rows that a model with it is fitted to.
    let extended = match candidate.effect.row().shows_at_turns {
        true => setup.with_reversals().extended(term),
        false => setup.extended(term),
    };
    let before = match extended.rows().eq(setup.rows()) {
        true => base.held_out,
        false => {
            let same = setup.clone().on_rows_of(&extended);
            fit(&same, &Design::new(&same)).held_out
        }
    };
    let after = fit(&extended, &Design::new(&extended));
    let id = candidate.id();
    let like = family::of(design, candidate, passing, &trial.candidates);
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
        separate_by: family::separate_by(setup, candidate, &like),
        next_experiment: family::proposal(candidate, &like),
        indistinguishable_from: like.iter().map(|c| c.id().to_owned()).collect(),
    }
}
