//! One recording put to the diagnosis, and what comes of its advice.

use ferntast_identification::{
    Dataset, Diagnosis, ModelSpec, Proposal, Term, Verdict, add, design::Design, diagnose,
    fit::fit, setup::Setup,
};
use ferntast_sim::joint_bench::{Bench, BenchConfig, BenchRecording, HiddenEffect, Motion};

use super::{
    super::bench::{dataset, model, session},
    Case,
    tally::FollowedUp,
};

/// Sessions of an experiment that the lab proposes.
const MORE_SESSIONS: usize = 6;

/// What the lab said of one recording.
pub(super) struct Given {
    pub(super) verdict: Verdict,
    pub(super) named: Option<String>,
    pub(super) family: Vec<String>,
    pub(super) suspected: Vec<String>,
    /// Error on data held out after adding what was named, over what the true
    /// model reaches; where the right effect was named.
    pub(super) over_true: Option<f64>,
    /// After the experiment that the lab proposed, where it proposed one.
    pub(super) followed_up: Option<FollowedUp>,
}

pub(super) fn ask(case: &Case) -> Result<Given, String> {
    let what = || case.hidden.map_or("nothing", HiddenEffect::id);
    answer(case).map_err(|error| format!("{} hidden, seed {}: {error}", what(), case.seed))
}

fn answer(case: &Case) -> Result<Given, String> {
    let config = BenchConfig {
        seed: case.seed,
        hidden: case.hidden.into_iter().collect(),
        strength: case.strength,
        ..BenchConfig::default()
    };
    let bench = Bench::new(&config).map_err(|error| error.to_string())?;
    let recording = bench.record().map_err(|error| error.to_string())?;
    let (data, believed) = (dataset(&recording), model(&recording));
    let diagnosis = put(&data, &believed)?;
    let accepted = case.hidden.map_or(&[][..], HiddenEffect::accepted);
    let is_right = |name: &String| accepted.contains(&name.as_str());
    let first = diagnosis.candidates.first();
    let named = first.map(|own| own.effect.clone());
    let family = first.map_or_else(Vec::new, |own| own.indistinguishable_from.clone());
    let over_true = match named.as_ref().filter(|name| is_right(name)) {
        Some(name) => {
            let term = Term::Catalogue(name.clone());
            let added = add(&data, &believed, &term).map_err(|error| error.to_string())?;
            Some(added.held_out_after / true_model_reaches(&config)?)
        }
        None => None,
    };
    let confused = !family.is_empty() && named.iter().chain(&family).any(|name| !is_right(name));
    let holds_truth = named.iter().chain(&family).any(is_right);
    let proposal = match (first, diagnosis.suspected.first()) {
        (Some(own), _) if confused && holds_truth => Some((own.next_experiment, true)),
        (None, Some(suspect)) if !accepted.is_empty() => Some((suspect.next_experiment, false)),
        _ => None,
    };
    let followed_up = match proposal {
        Some((proposal, was_family)) => {
            let after = put(&joined(&bench, &recording, data, proposal)?, &believed)?;
            let first = after.candidates.first();
            let only = |own: &&diagnose::NamedCandidate| {
                is_right(&own.effect) && own.indistinguishable_from.iter().all(is_right)
            };
            Some(FollowedUp {
                experiment: proposal.id().to_owned(),
                was_family,
                resolved: first.filter(only).is_some(),
                named: first.map(|own| own.effect.clone()),
            })
        }
        None => None,
    };
    Ok(Given {
        verdict: diagnosis.verdict,
        suspected: diagnosis
            .suspected
            .into_iter()
            .map(|own| own.effect)
            .collect(),
        named,
        family,
        over_true,
        followed_up,
    })
}

fn put(data: &Dataset, believed: &ModelSpec) -> Result<Diagnosis, String> {
    diagnose(data, believed, &mut |_| {}).map_err(|error| error.to_string())
}

/// The recording with the experiment that was proposed: same joint, same
/// hidden effect, later days.
fn joined(
    bench: &Bench,
    recording: &BenchRecording,
    mut data: Dataset,
    proposal: Proposal,
) -> Result<Dataset, String> {
    let motion: Motion = proposal.id().parse().map_err(describe)?;
    let more = bench
        .follow_up(recording, motion, MORE_SESSIONS)
        .map_err(describe)?;
    for own in &more {
        let number = data.sessions.len() + 1;
        data.sessions.push(session(own, number));
    }
    Ok(data)
}

fn describe(error: ferntast_sim::joint_bench::BenchError) -> String {
    error.to_string()
}

/// Error \[Nm\] on data held out that equation (4), fitted, leaves on the same
/// recording without the hidden effect: same joint, motion, scatter and noise.
/// No model that has the effect exactly can do better.
fn true_model_reaches(config: &BenchConfig) -> Result<f64, String> {
    let config = BenchConfig {
        hidden: Vec::new(),
        ..config.clone()
    };
    let recording = Bench::new(&config)
        .and_then(|bench| bench.record())
        .map_err(describe)?;
    let setup =
        Setup::new(&dataset(&recording), &model(&recording)).map_err(|error| error.to_string())?;
    Ok(fit(&setup, &Design::new(&setup)).held_out)
}
