//! Recordings like real ones put to the diagnosis: how often it names what is not there.

use std::collections::BTreeMap;

use ferntast_benches::joint_bench::{
    BenchRecording, BenchSession, HiddenEffect, Motion, RealLike, RealLikeBench,
};
use ferntast_identification::{
    Dataset, Inertia, ModelSpec, RecordedSession, Term, Verdict, add, diagnose,
};
use serde::{Deserialize, Serialize};

use super::{super::TestBench, count::Count};

/// Sessions of a fresh run of a joint.
const FRESH_SESSIONS: usize = 2;

/// A recording to be made.
#[derive(Clone, Copy)]
pub(super) struct RealCase {
    pub(super) kind: RealLike,
    pub(super) seed: u64,
}

/// What the lab said of one recording.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RealAnswer {
    /// Kind of the recording.
    pub kind: String,
    /// Its seed.
    pub seed: u64,
    /// Ids of what is there beside what is believed, the hidden effect's first; of a law that
    /// no catalogue has: the law in words.
    pub there: Vec<String>,
    /// The verdict.
    pub verdict: Verdict,
    /// The effect that was named first.
    pub named: Option<String>,
    /// Whether that is there; of a law: whether nothing was named, or what was named lowers
    /// the error, and the verdict is not complete.
    pub right: bool,
    /// Whether it was told to be indistinguishable from what is there.
    pub in_family: bool,
    /// Whether a name was given that is not there.
    pub is_false_name: bool,
    /// Error by the truth of a fresh run of the same joint without and with what was named
    /// \[Nm\], of a law.
    pub fresh: Option<[f64; 2]>,
}

/// How the diagnosis did on recordings of one kind.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RealLikeRow {
    /// Recordings.
    pub recordings: usize,
    /// Of those with anything there, in which that was named first.
    pub right_first: Count,
    /// The same, or told to be indistinguishable from what was named.
    pub in_family: Count,
    /// Names that are not there: another effect than what is, any where nothing is; of a law
    /// outside the catalogue an effect that does not lower the error of a fresh run.
    pub false_names: Count,
    /// Those of them for which the right one was told to be indistinguishable.
    pub false_in_family: usize,
    /// Every false name.
    pub misses: Vec<RealAnswer>,
}

impl RealLikeRow {
    pub(super) fn note(&mut self, own: RealAnswer) {
        self.recordings += 1;
        if !own.there.is_empty() {
            self.right_first.note(own.right);
            self.in_family.note(own.right || own.in_family);
        }
        self.false_names.note(own.is_false_name);
        self.false_in_family += usize::from(own.is_false_name && own.in_family);
        if own.is_false_name {
            self.misses.push(own);
        }
    }
}

/// The seed's recordings of these kinds, `count` of each.
pub(super) fn cases(kinds: &[RealLike], count: usize, seed: u64) -> Vec<RealCase> {
    let first = seed.wrapping_add(3_000_000);
    let each = kinds.iter().flat_map(|&kind| {
        // The same joints in each kind would make its rates go together.
        let of_kind = first.wrapping_add(100_000 * kind as u64);
        (0..count as u64).map(move |number| RealCase {
            kind,
            seed: of_kind.wrapping_add(number),
        })
    });
    each.collect()
}

pub(super) fn ask(case: &RealCase) -> Result<RealAnswer, String> {
    let of = |error: String| format!("{}, seed {}: {error}", case.kind, case.seed);
    answer(case).map_err(of)
}

fn answer(case: &RealCase) -> Result<RealAnswer, String> {
    let drawn = RealLikeBench::draw(case.kind, case.seed).map_err(|error| error.to_string())?;
    let recording = drawn.bench.record().map_err(|error| error.to_string())?;
    let mut data = HiddenEffect::dataset(&recording);
    // Whoever has no sensor knows it.
    for session in &mut data.sessions {
        session.torque_is_modelled = case.kind == RealLike::UncertainLoad;
    }
    let mut believed = HiddenEffect::model(&recording);
    if case.kind == RealLike::ColdStart {
        let sessions = data.sessions.iter_mut();
        sessions.for_each(|session| session.temperature = None);
    }
    if case.kind == RealLike::MotorOnly {
        let sessions = data.sessions.iter_mut();
        sessions.for_each(|session| session.joint_torque = None);
        believed.inertia = Inertia::Fit;
    }
    let told = diagnose(&data, &believed, &mut |_| {}).map_err(|error| error.to_string())?;
    let first = (told.candidates.first()).filter(|_| told.verdict == Verdict::Missing);
    let named = first.map(|own| own.effect.clone());
    let accepted = drawn.accepted();
    let is_there = |name: &String| accepted.contains(&name.as_str());
    let mut answer = RealAnswer {
        kind: case.kind.id().to_owned(),
        seed: case.seed,
        there: accepted.iter().map(|id| (*id).to_owned()).collect(),
        verdict: told.verdict,
        right: named.as_ref().is_some_and(is_there),
        in_family: first.is_some_and(|own| own.indistinguishable_from.iter().any(is_there)),
        is_false_name: named.as_ref().is_some_and(|name| !is_there(name)),
        named,
        fresh: None,
    };
    if let Some(law) = drawn.law {
        answer.there = vec![law];
        answer.is_false_name = false;
        if let Some(name) = &answer.named {
            let fresh = on_a_fresh_run(&drawn.bench, &recording, data, &believed, name)?;
            answer.is_false_name = fresh[1] >= fresh[0];
            answer.fresh = Some(fresh);
        }
        answer.right = !answer.is_false_name && answer.verdict != Verdict::Complete;
    }
    Ok(answer)
}

/// Error \[Nm\] of the model without and with the effect `name`, fitted to the recording, on
/// what is true of another run of the same joint.
fn on_a_fresh_run(
    bench: &ferntast_benches::joint_bench::Bench,
    recording: &BenchRecording,
    mut data: Dataset,
    believed: &ModelSpec,
    name: &str,
) -> Result<[f64; 2], String> {
    let fresh = bench.follow_up(recording, Motion::Standard, FRESH_SESSIONS);
    let fresh = fresh.map_err(|error| error.to_string())?;
    data.held_out = fresh.iter().map(truth).collect();
    let term = Term::Catalogue(name.to_owned());
    let added = add(&data, believed, &term).map_err(|error| error.to_string())?;
    Ok([added.held_out_before, added.held_out_after])
}

/// What is true of a session, without noise.
fn truth(own: &BenchSession) -> RecordedSession {
    RecordedSession {
        name: "fresh run".to_owned(),
        start: own.start,
        period: own.period,
        position: own.truth.position.clone(),
        motor_torque: own.truth.motor_torque.clone(),
        joint_torque: Some(own.truth.joint_torque.clone()),
        temperature: Some(own.truth.temperature.clone()),
        ..RecordedSession::default()
    }
}

/// Rows by kind.
pub(super) type Rows = BTreeMap<String, RealLikeRow>;
