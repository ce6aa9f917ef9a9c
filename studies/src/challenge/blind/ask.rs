//! One recording put to the diagnosis, and what comes of its advice.

use std::{collections::BTreeMap, fmt::Display};

use ferntast_identification::{
    CustomEffect, Dataset, Diagnosis, ModelSpec, Proposal, RecordedSession, Term, Verdict, add,
    design::Design, diagnose, diagnosis::NamedCandidate, fit::fit, prepare,
};

use serde::{Deserialize, Serialize};

use super::{super::TestBench, Case, Made};

/// Sessions of an experiment that the lab proposes.
const MORE_SESSIONS: usize = 6;

/// The signal that a true model has and nobody else.
const HIDDEN_PART: &str = "hidden";

/// What the lab said of one recording.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Given {
    pub(super) verdict: Verdict,
    pub(super) named: Option<String>,
    pub(super) family: Vec<String>,
    pub(super) suspected: Vec<String>,
    /// Error on data held out after adding what was named, over what the true
    /// model reaches on the same recording; where the right effect was named.
    pub(super) over_true: Option<f64>,
    /// After the experiment that the lab proposed, where it proposed one.
    pub(super) followed_up: Option<FollowedUp>,
}

/// What came of the experiment that the lab proposed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FollowedUp {
    /// Which experiment.
    pub experiment: String,
    /// Whether it was to split a family; else, to prove a suspicion.
    pub was_family: bool,
    /// Whether the right effect was named then, and no other beside it.
    pub resolved: bool,
    /// What was named first then.
    pub named: Option<String>,
}

pub(super) fn ask<H: TestBench>(case: &Case<H>, made: &Made<H>) -> Result<Given, String> {
    answer(case, made).map_err(|error| format!("{}: {error}", case.told()))
}

fn answer<H: TestBench>(case: &Case<H>, made: &Made<H>) -> Result<Given, String> {
    let Made { bench, recording } = made;
    let (data, believed) = (H::dataset(recording), H::model(recording));
    let diagnosis = put(&data, &believed)?;
    let accepted = case.hidden.map_or(&[][..], H::accepted);
    let is_right = |name: &String| accepted.contains(&name.as_str());
    let first = diagnosis.candidates.first();
    let named = first.map(|own| own.effect.clone());
    let family = first.map_or_else(Vec::new, |own| own.indistinguishable_from.clone());
    let over_true = match named.as_ref().filter(|name| is_right(name)) {
        Some(name) => {
            let term = Term::Catalogue(name.clone());
            let added = add(&data, &believed, &term).map_err(describe)?;
            Some(added.held_out_after / true_model_reaches::<H>(&data, &believed, recording)?)
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
            let after = put(&joined::<H>(bench, recording, data, proposal)?, &believed)?;
            let first = after.candidates.first();
            let only = |own: &&NamedCandidate| {
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
    diagnose(data, believed, &mut |_| {}).map_err(describe)
}

/// The recording with the experiment that was proposed: same joint, same
/// hidden effect, later days.
fn joined<H: TestBench>(
    bench: &H::Bench,
    recording: &H::Recording,
    mut data: Dataset,
    proposal: Proposal,
) -> Result<Dataset, String> {
    let motion: H::Motion = proposal.id().parse().map_err(describe)?;
    let more = H::follow_up(bench, recording, motion, MORE_SESSIONS).map_err(describe)?;
    data.sessions.extend(more);
    Ok(data)
}

fn describe(error: impl Display) -> String {
    error.to_string()
}

/// Error \[Nm, of a contact N\] on data held out that the true model reaches on
/// `recording`, whose sessions are `data`.
///
/// Where the hidden effect acts on the driving torque or force alone, the true
/// model is what everybody believes and that very part of it; how much of it,
/// is found in the same sessions. Where it acts on other channels too, it is what
/// everybody believes, fitted to the same motion, noise and scatter with nothing
/// hidden.
///
/// The rows are those of sliding, also where what was added is fitted to turns.
/// At turns the friction of everybody's model jumps with the sign of a velocity
/// that nobody can measure; a true model that is smooth there leaves noise and
/// scatter, as it does in sliding.
pub(in crate::challenge) fn true_model_reaches<H: TestBench>(
    data: &Dataset,
    believed: &ModelSpec,
    recording: &H::Recording,
) -> Result<f64, String> {
    let without = H::without_hidden(recording);
    let nothing_hidden = H::dataset(&without);
    let reaches = |data: &Dataset, model: &ModelSpec| {
        let prepared = prepare(data, model).map_err(describe)?;
        Ok(fit(&prepared, &Design::new(&prepared)).held_out)
    };
    match with_hidden_part(data, &nothing_hidden) {
        Some(data) => {
            let mut model = believed.clone();
            model.effects.push(Term::Custom(CustomEffect {
                name: HIDDEN_PART.to_owned(),
                expression: format!("share*{HIDDEN_PART}"),
                bounds: BTreeMap::new(),
            }));
            reaches(&data, &model)
        }
        None => reaches(&nothing_hidden, &H::model(&without)),
    }
}

/// `data` with the hidden part of the driving torque or force as a signal; `None`
/// where there is none of it, or `nothing_hidden` differs in other channels too.
fn with_hidden_part(data: &Dataset, nothing_hidden: &Dataset) -> Option<Dataset> {
    let mut with = data.clone();
    let mut is_there = false;
    for (session, plain) in with.sessions.iter_mut().zip(&nothing_hidden.sessions) {
        let same_otherwise = RecordedSession {
            motor_torque: session.motor_torque.clone(),
            ..plain.clone()
        };
        if *session != same_otherwise {
            return None;
        }
        let torques = session.motor_torque.iter().zip(&plain.motor_torque);
        let hidden: Vec<f64> = torques.map(|(all, plain)| all - plain).collect();
        is_there |= hidden.iter().any(|torque| torque.abs() > 1e-9);
        session.extra.insert(HIDDEN_PART.to_owned(), hidden);
    }
    is_there.then_some(with)
}
