//! The joint bench's recordings as the identification wants them.

use ferntast_identification::{Dataset, Inertia, JointType, ModelSpec, Session, Term};
use ferntast_sim::joint_bench::{BenchRecording, BenchSession, HiddenEffect, LOG_PERIOD};

/// The recording's sessions.
pub fn dataset(recording: &BenchRecording) -> Dataset {
    let sessions = recording.sessions.iter().enumerate();
    Dataset {
        sessions: sessions
            .map(|(index, own)| session(own, index + 1))
            .collect(),
        held_out: Vec::new(),
        joint: JointType::Revolute,
        filter: None,
    }
}

/// Session `number` of a recording. Whoever runs it knows whether there are
/// springs to pull.
pub fn session(own: &BenchSession, number: usize) -> Session {
    Session {
        name: format!("session {number}"),
        start: own.start,
        period: LOG_PERIOD,
        position: own.position.clone(),
        motor_torque: own.motor_torque.clone(),
        joint_torque: Some(own.joint_torque.clone()),
        temperature: Some(own.temperature.clone()),
        unloaded: own.motion.is_some_and(|motion| !motion.has_springs()),
        ..Session::default()
    }
}

/// What the experimenter believes: the truth without what is hidden.
pub fn model(recording: &BenchRecording) -> ModelSpec {
    let believed = &recording.believed;
    ModelSpec {
        inertia: Inertia::Given(believed.inertia),
        gear_ratio: Some(believed.gear_ratio),
        effects: believed
            .effects
            .iter()
            .map(|id| Term::Catalogue((*id).to_owned()))
            .collect(),
    }
}

/// The effect that `seed` hides; now and then it is nothing.
pub fn hidden_by(seed: u64) -> Option<HiddenEffect> {
    // SplitMix64's finaliser: neighbouring seeds hide unrelated effects.
    let mut mixed = seed.wrapping_add(0x9E37_79B9_7F4A_7C15);
    mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    mixed ^= mixed >> 31;
    let choices = HiddenEffect::ALL.len() as u64 + 1;
    usize::try_from(mixed % choices)
        .ok()
        .and_then(|index| HiddenEffect::ALL.get(index).copied())
}
