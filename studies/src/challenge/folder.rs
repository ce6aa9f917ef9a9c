//! A challenge on disk: recording, experiment file, sealed answer.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use ferntast_bag::{CreateBagError, FinishBagError};
use ferntast_benches::bench::{BenchConfig, BenchError};
use ferntast_bus::{Bus, McapBus};
use serde::{Deserialize, Serialize};

use super::{TestBench, WriteError};

const SEALED: &str = "answer.sealed";

/// What was hidden.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Answer {
    /// Ids of the hidden effects; empty where nothing is.
    pub hidden: Vec<String>,
    /// Ids that count as right.
    pub accepted: Vec<String>,
    /// Strength.
    pub strength: f64,
    /// Seed.
    pub seed: u64,
    /// True parameters: name, value, unit.
    pub truth: Vec<(String, f64, String)>,
    /// Error that the true model leaves with nominal parameters \[Nm, of a contact N\].
    pub reference_rms: f64,
}

/// Why there is no challenge, or none to open.
#[derive(Debug, thiserror::Error)]
pub enum ChallengeError {
    /// The bench refuses.
    #[error(transparent)]
    Bench(#[from] BenchError),
    /// The folder is there already.
    #[error("{0} exists already: choose another folder")]
    Exists(PathBuf),
    /// A file cannot be written or read.
    #[error("{path}: {source}")]
    File {
        /// Which.
        path: PathBuf,
        /// The operating system's reason.
        source: io::Error,
    },
    /// The recording cannot be made.
    #[error(transparent)]
    Bag(#[from] CreateBagError),
    /// The recording cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The recording cannot be closed.
    #[error(transparent)]
    Finish(#[from] FinishBagError),
    /// The answer is not one of ours.
    #[error("{0} holds no sealed answer of `ferntast challenge new`")]
    Broken(PathBuf),
}

/// Makes a challenge in `folder`, which must not exist.
///
/// # Errors
///
/// [`ChallengeError`].
pub fn create<H: TestBench>(
    folder: &Path,
    config: &BenchConfig<H, H::Motion>,
) -> Result<(), ChallengeError> {
    if folder.exists() {
        return Err(ChallengeError::Exists(folder.to_owned()));
    }
    let recording = H::record(&H::bench(config)?)?;
    let at = |name: &str| folder.join(name);
    let file = |path: PathBuf| move |source| ChallengeError::File { path, source };
    fs::create_dir_all(folder).map_err(file(folder.to_owned()))?;
    let bag = McapBus::create(&at("recording"))?;
    H::publish(&recording, &Bus::Mcap(bag.clone()))?;
    bag.finish()?;
    fs::write(at("experiment.toml"), H::experiment(&recording)?)
        .map_err(file(at("experiment.toml")))?;
    let answer = Answer {
        hidden: ids(&config.hidden, |own| vec![own.id()]),
        accepted: ids(&config.hidden, |own| own.accepted().to_vec()),
        strength: config.strength,
        seed: config.seed,
        truth: H::truth(&recording)
            .iter()
            .map(|own| (own.name.to_owned(), own.value, own.unit.to_owned()))
            .collect(),
        reference_rms: H::reference_rms(&recording),
    };
    let text = serde_json::to_string(&answer)
        .map_err(|error| file(at(SEALED))(io::Error::other(error)))?;
    fs::write(at(SEALED), seal(&text)).map_err(file(at(SEALED)))
}

/// Opens the sealed answer in `folder`.
///
/// # Errors
///
/// There is none, or it is broken.
pub fn reveal(folder: &Path) -> Result<Answer, ChallengeError> {
    let path = folder.join(SEALED);
    let sealed = fs::read_to_string(&path).map_err(|source| ChallengeError::File {
        path: path.clone(),
        source,
    })?;
    unseal(&sealed)
        .and_then(|text| serde_json::from_str(&text).ok())
        .ok_or(ChallengeError::Broken(path))
}

fn ids<T>(of: &[T], each: impl Fn(&T) -> Vec<&'static str>) -> Vec<String> {
    of.iter().flat_map(each).map(str::to_owned).collect()
}

/// Not a secret, only not readable by accident: bytes turned and in hexadecimal.
fn seal(text: &str) -> String {
    let bytes = text.bytes().rev();
    bytes.map(|byte| format!("{:02x}", byte ^ 0x5a)).collect()
}

fn unseal(sealed: &str) -> Option<String> {
    let digits = sealed.trim().as_bytes();
    let mut bytes: Vec<u8> = digits
        .chunks(2)
        .map(|pair| {
            let pair = std::str::from_utf8(pair).ok()?;
            Some(u8::from_str_radix(pair, 16).ok()? ^ 0x5a)
        })
        .collect::<Option<_>>()?;
    bytes.reverse();
    String::from_utf8(bytes).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_sealed_is_opened_and_not_read_by_accident() {
        let sealed = seal("{\"hidden\":[\"stribeck\"]}");
        assert!(!sealed.contains("stribeck"));
        assert_eq!(
            unseal(&sealed).as_deref(),
            Some("{\"hidden\":[\"stribeck\"]}")
        );
        assert_eq!(unseal("xyz"), None);
        assert_eq!(unseal("é"), None);
    }
}
