//! A challenge as it is asked for.

use std::path::{Path, PathBuf};

use ferntast_benches::{
    bench::{BenchConfig, BenchError},
    contact_bench, joint_bench,
};

use super::{ChallengeError, TestBench, create, hidden_by};

/// What a challenge is asked to be like.
#[derive(Clone, Debug, PartialEq)]
pub struct Asked {
    /// Decides joint or edge, sessions, noise, and what is hidden.
    pub seed: u64,
    /// Size of the hidden effect: 1 is plain to see, 0.25 is hard.
    pub strength: f64,
    /// Ids of what is hidden, or `none`; empty for what the seed says.
    pub hide: Vec<String>,
    /// Sessions; else as many as the bench has.
    pub sessions: Option<usize>,
}

/// Makes it in `folder`, which must not exist, of a joint or a contact; gives the
/// experiment file.
///
/// # Errors
///
/// [`ChallengeError`].
pub fn make(folder: &Path, contact: bool, asked: &Asked) -> Result<PathBuf, ChallengeError> {
    match contact {
        true => make_of::<contact_bench::HiddenEffect>(folder, asked)?,
        false => make_of::<joint_bench::HiddenEffect>(folder, asked)?,
    }
    Ok(folder.join("experiment.toml"))
}

fn make_of<H: TestBench>(folder: &Path, asked: &Asked) -> Result<(), ChallengeError> {
    let config = BenchConfig {
        seed: asked.seed,
        hidden: hidden::<H>(asked.seed, &asked.hide)?,
        strength: asked.strength,
        sessions: asked.sessions.unwrap_or(H::SESSIONS),
        ..BenchConfig::default()
    };
    create(folder, &config)
}

fn hidden<H: TestBench>(seed: u64, hide: &[String]) -> Result<Vec<H>, BenchError> {
    match hide {
        [] => Ok(hidden_by(seed).into_iter().collect()),
        [none] if none == "none" => Ok(Vec::new()),
        ids => ids.iter().map(|id| id.parse()).collect(),
    }
}
