//! How one experiment came out of another.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs::File,
    io::{self, Read},
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::{Experiment, ExperimentError};

/// The section `[lineage]`: what was done to the parent to get this file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lineage {
    /// The experiment file that this one came out of, relative to this one.
    pub parent: String,
    /// Id or name of the effect that was added.
    #[serde(default)]
    pub effect: Option<String>,
    /// Whether it goes on with what the parent's twin saw: the recordings are others then.
    #[serde(default)]
    pub from_twin: bool,
    /// SHA-256 over the content of the recordings, fitted ones first,
    /// hexadecimal.
    pub data_sha256: String,
    /// Error on data not fitted, of the parent's model.
    pub held_out_before: f64,
    /// Error on data not fitted, of this model.
    pub held_out_after: f64,
    /// Unit of both errors.
    pub unit: String,
    /// The parameters by name: fitted, or as the twin found them.
    #[serde(default)]
    pub parameters: BTreeMap<String, FittedParameter>,
}

/// A fitted parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FittedParameter {
    /// Its value.
    pub value: f64,
    /// Its standard error; nothing where it could not be determined.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub std_error: Option<f64>,
    /// Unit of both.
    pub unit: String,
}

/// One experiment of a chain.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HistoryStep {
    /// The experiment file.
    pub experiment: PathBuf,
    /// Names of the effects in its model.
    pub effects: Vec<String>,
    /// The effect that was added to get here; `None` for the first, and where only the recordings are others.
    pub added: Option<String>,
    /// Error on data not fitted; `None` for a first one that nothing was added to.
    pub held_out: Option<f64>,
    /// Unit of the error.
    pub unit: Option<String>,
    /// Whether the recordings are others than in the step before.
    pub other_data: bool,
    /// The fitted parameters.
    pub parameters: BTreeMap<String, FittedParameter>,
}

/// The chain of experiments that ends with the file at `path`, the first one
/// first. Where a parent is no longer there, the chain begins behind it.
///
/// # Errors
///
/// A file of the chain cannot be used, or descends from itself.
pub fn history(path: &Path, data_folder: &Path) -> Result<Vec<HistoryStep>, ExperimentError> {
    let mut seen = BTreeSet::new();
    let mut chain = Vec::new();
    let mut next = Some(path.to_owned());
    while let Some(path) = next {
        let known = path.canonicalize().unwrap_or_else(|_| path.clone());
        if !seen.insert(known) {
            return Err(ExperimentError::Circle { path });
        }
        let experiment = Experiment::read(&path, data_folder)?;
        let lineage = experiment.lineage.clone();
        next = lineage
            .map(|lineage| super::folder_of(&path).join(lineage.parent))
            .filter(|parent| parent.exists());
        chain.push((path, experiment));
    }
    chain.reverse();
    let mut steps: Vec<HistoryStep> = Vec::new();
    let mut data: Option<String> = None;
    for (path, experiment) in chain {
        let effects = experiment.model.effects.iter();
        let effects = effects.map(|term| term.name().to_owned()).collect();
        let lineage = experiment.lineage;
        // What the first one's error was, its first child tells.
        if let (Some(lineage), Some(first)) = (&lineage, steps.last_mut())
            && first.held_out.is_none()
        {
            first.held_out = Some(lineage.held_out_before);
            first.unit = Some(lineage.unit.clone());
        }
        let hash = lineage.as_ref().map(|lineage| lineage.data_sha256.clone());
        let other_data = matches!((&data, &hash), (Some(before), Some(now)) if before != now)
            || lineage.as_ref().is_some_and(|lineage| lineage.from_twin);
        data = hash.or(data);
        steps.push(HistoryStep {
            experiment: path,
            effects,
            added: lineage.as_ref().and_then(|lineage| lineage.effect.clone()),
            held_out: lineage.as_ref().map(|lineage| lineage.held_out_after),
            unit: lineage.as_ref().map(|lineage| lineage.unit.clone()),
            other_data,
            parameters: lineage
                .map(|lineage| lineage.parameters)
                .unwrap_or_default(),
        });
    }
    Ok(steps)
}

/// SHA-256 over the content of recordings, hexadecimal. Of a directory its
/// `.mcap` files count, in the order of their names.
///
/// # Errors
///
/// The file that cannot be read, with what the system said.
pub fn data_hash(paths: &[PathBuf]) -> Result<String, (PathBuf, io::Error)> {
    let mut hash = Sha256::new();
    for path in paths {
        for file in files_of(path).map_err(|error| (path.clone(), error))? {
            add(&mut hash, &file).map_err(|error| (file.clone(), error))?;
        }
    }
    let digest = hash.finalize();
    Ok(digest.iter().map(|byte| format!("{byte:02x}")).collect())
}

fn files_of(path: &Path) -> io::Result<Vec<PathBuf>> {
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let entries: io::Result<Vec<_>> = path.read_dir()?.collect();
    let mut files: Vec<PathBuf> = entries?.iter().map(std::fs::DirEntry::path).collect();
    files.retain(|file| file.extension().is_some_and(|ending| ending == "mcap"));
    files.sort();
    Ok(files)
}

fn add(hash: &mut Sha256, file: &Path) -> io::Result<()> {
    let mut file = File::open(file)?;
    let length = file.metadata()?.len();
    // So that moving a byte from one file into the next shows.
    hash.update(length.to_le_bytes());
    let mut buffer = vec![0; 1 << 16];
    loop {
        match file.read(&mut buffer)? {
            0 => return Ok(()),
            count => hash.update(buffer.get(..count).unwrap_or_default()),
        }
    }
}
