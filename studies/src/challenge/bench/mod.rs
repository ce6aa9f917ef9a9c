//! The benches' recordings as the identification and the disk want them.

mod contact;
mod joint;

use std::str::FromStr;

use ferntast_benches::bench::{BenchConfig, BenchError, Hideable, TrueParameter};
use ferntast_bus::{Bus, CreateError, PublishError};
use ferntast_emulation::random::mixed;
use ferntast_identification::{Dataset, Inertia, ModelSpec, RecordedSession, Term};
use ferntast_msgs::{
    Time,
    sample::{JointNames, TemperatureSample},
    topics::{FOLLOWER_JOINT_TEMPERATURE, Topic},
};

/// Date of the first session: when ROKVISS went into operation.
const FIRST_SESSION: i64 = 1_107_216_000;

/// Why a recording is not written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// A topic cannot be made in it.
    #[error(transparent)]
    Topic(#[from] CreateError),
    /// A message cannot be written.
    #[error(transparent)]
    Publish(#[from] PublishError),
}

/// What a bench can hide, and how it is recorded.
pub trait TestBench: Hideable + FromStr<Err = BenchError> {
    /// How a session moves.
    type Motion: Clone + Default + FromStr<Err = BenchError> + Send + Sync;
    /// The bench with what it hides.
    type Bench;
    /// Its sessions and the answer.
    type Recording;

    /// Sessions of a recording, unless others are asked for.
    const SESSIONS: usize;

    /// Draws a bench.
    ///
    /// # Errors
    ///
    /// A value is out of bounds, or effects do not go together.
    fn bench(config: &BenchConfig<Self, Self::Motion>) -> Result<Self::Bench, BenchError>;

    /// Runs every session.
    ///
    /// # Errors
    ///
    /// As the bench has it.
    fn record(bench: &Self::Bench) -> Result<Self::Recording, BenchError>;

    /// Runs more sessions on the same bench, on later dates, and gives them as
    /// they follow on the recording's.
    ///
    /// # Errors
    ///
    /// As the bench has it.
    fn follow_up(
        bench: &Self::Bench,
        recording: &Self::Recording,
        motion: Self::Motion,
        sessions: usize,
    ) -> Result<Vec<RecordedSession>, BenchError>;

    /// The same recording with nothing hidden: what the believed model, fitted to
    /// it, reaches is what the true model reaches on `recording`.
    fn without_hidden(recording: &Self::Recording) -> Self::Recording;

    /// The recording's sessions.
    fn dataset(recording: &Self::Recording) -> Dataset;

    /// What the experimenter believes: the truth without what is hidden.
    fn model(recording: &Self::Recording) -> ModelSpec;

    /// Every true parameter.
    fn truth(recording: &Self::Recording) -> &[TrueParameter<Self>];

    /// Error that the true model leaves with nominal parameters \[Nm, of a contact N\].
    fn reference_rms(recording: &Self::Recording) -> f64;

    /// Writes the messages.
    ///
    /// # Errors
    ///
    /// The bus refuses.
    fn publish(recording: &Self::Recording, bus: &Bus) -> Result<(), WriteError>;

    /// The experiment file, for a recording beside it.
    ///
    /// # Errors
    ///
    /// A topic has no name.
    fn experiment(recording: &Self::Recording) -> Result<String, WriteError>;
}

/// When a log entry `time` \[s\] into a session that began at `start` \[s\] was made.
fn stamp(start: f64, time: f64) -> Time {
    Time::from_nanos(FIRST_SESSION * 1_000_000_000)
        .plus_seconds(start)
        .plus_seconds(time)
}

/// A model with these effects.
fn model_of(inertia: f64, gear_ratio: Option<f64>, effects: &[&'static str]) -> ModelSpec {
    let effects = effects.iter();
    ModelSpec {
        inertia: Inertia::Given(inertia),
        gear_ratio,
        effects: effects
            .map(|id| Term::Catalogue((*id).to_owned()))
            .collect(),
    }
}

/// The joints in the recording of a bench, of which the first is the bench's.
fn joints() -> JointNames {
    JointNames::numbered(2)
}

/// Where the bench's temperature is recorded.
fn temperature_topic() -> Result<Topic<TemperatureSample>, CreateError> {
    let joints = joints();
    let topic = FOLLOWER_JOINT_TEMPERATURE.of(joints.get(0).unwrap_or_default())?;
    Ok(topic)
}

/// `"a", "b"`.
fn quoted(ids: &[&'static str]) -> String {
    let quoted: Vec<String> = ids.iter().map(|id| format!("\"{id}\"")).collect();
    quoted.join(", ")
}

/// The effect that `seed` hides; now and then it is nothing. A catalogue that
/// grows changes what a seed hides only where the new effect is hidden: the
/// largest of the numbers that seed and id give wins (rendezvous hashing).
pub fn hidden_by<H: TestBench>(seed: u64) -> Option<H> {
    let next = |number: u64| mixed(number.wrapping_add(0x9E37_79B9_7F4A_7C15));
    let drawn = |id: &str| {
        id.bytes()
            .fold(next(seed), |so_far, byte| next(so_far ^ u64::from(byte)))
    };
    let largest = H::ALL.iter().copied().max_by_key(|own| drawn(own.id()))?;
    (drawn(largest.id()) > drawn("none")).then_some(largest)
}

#[cfg(test)]
mod tests {
    use ferntast_benches::{contact_bench, joint_bench};
    use ferntast_identification::{EffectDescription, Subject, catalogue};

    use super::*;

    fn truths<H: TestBench>() -> Vec<&'static str> {
        let known = H::ALL.iter().filter(|own| own.in_catalogue());
        known.map(|own| own.id()).collect()
    }

    /// What the lab can name can be hidden from it, and the other way round.
    #[test]
    fn every_effect_of_the_catalogue_has_a_truth() {
        for (subject, truths) in [
            (Subject::Joint, truths::<joint_bench::HiddenEffect>()),
            (Subject::Contact, truths::<contact_bench::HiddenEffect>()),
        ] {
            // A second one of a kind is hidden where the first is known, and what shows only where
            // something is not measured in recordings without that: in tests of the lab.
            let first = |own: &EffectDescription| {
                own.of == subject && own.another.is_none() && own.of_unmeasured.is_none()
            };
            let own = catalogue().into_iter().filter(first);
            let mut own: Vec<String> = own.map(|own| own.id).collect();
            let mut truths = truths.clone();
            own.sort_unstable();
            truths.sort_unstable();
            assert_eq!(own, truths);
        }
    }
}
