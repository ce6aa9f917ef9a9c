//! A mapping becomes an experiment file, or changes one. Nothing is written that
//! does not load.

use std::{
    fs,
    io::{self, Write as _},
    path::{Path, PathBuf},
};

use sha2::{Digest, Sha256};

use super::{WorkError, read::WhatIsRead};
use crate::experiment::{self, Change, Changed, Experiment, Mapped, Mapping};

/// An experiment file that is mapped again.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Again {
    /// The file.
    pub path: PathBuf,
    /// Its content as the user saw it: [`Present::version`].
    pub version: String,
}

/// The mapping of an experiment file as it is now.
#[derive(Clone, Debug, PartialEq)]
pub struct Present {
    /// The mapping, and what else is in the file.
    pub mapped: Mapped,
    /// What tells this content of the file from another.
    pub version: String,
}

/// What was written.
#[derive(Clone, Debug, PartialEq)]
pub struct Started {
    /// What is read of its recordings.
    pub read: WhatIsRead,
    /// What of an experiment file that was mapped again is replaced.
    pub changes: Vec<Change>,
}

/// Reads the mapping of the experiment file at `path`; its recordings need not be there.
///
/// # Errors
///
/// [`WorkError`]: it is no experiment file; the URDF that it names cannot be read.
pub fn mapping_of(path: &Path) -> Result<Present, WorkError> {
    let text = read(path)?;
    Ok(Present {
        mapped: Mapping::parse(&text, path)?,
        version: version(&text),
    })
}

/// The text that [`start`] writes, with what it replaces in a file that is mapped again.
///
/// # Errors
///
/// [`WorkError::Changed`]; the file that is mapped again cannot be read.
pub fn text(mapping: &Mapping, again: Option<&Again>, output: &Path) -> Result<Changed, WorkError> {
    let Some(again) = again else {
        return Ok(Changed {
            text: mapping.document(),
            changes: Vec::new(),
        });
    };
    let text = read(&again.path)?;
    if version(&text) != again.version {
        return Err(WorkError::Changed {
            path: again.path.clone(),
        });
    }
    Ok(mapping.put_into(&text, &again.path, output)?)
}

/// Writes the experiment file at `output`, once its recordings were read as it says.
/// A file that is there stays, but for the one that is mapped again, or with `force`.
///
/// # Errors
///
/// The file exists; it cannot be written; its recordings cannot be used (then it is
/// not written).
pub fn start(
    mapping: &Mapping,
    again: Option<&Again>,
    output: &Path,
    force: bool,
) -> Result<Started, WorkError> {
    let over = force || again.is_some_and(|again| again.path == output);
    if output.exists() && !over {
        return Err(WorkError::Exists {
            path: output.to_owned(),
        });
    }
    let Changed { text, changes } = text(mapping, again, output)?;
    let experiment = Experiment::parse(&text, output, &experiment::data_folder())?;
    let what = WhatIsRead::of(&experiment)?;
    let written = match over {
        true => replace(output, &text),
        false => fs::File::create_new(output).and_then(|mut file| file.write_all(text.as_bytes())),
    };
    match written {
        Ok(()) => Ok(Started {
            read: what,
            changes,
        }),
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => Err(WorkError::Exists {
            path: output.to_owned(),
        }),
        Err(source) => Err(WorkError::File {
            path: output.to_owned(),
            source,
        }),
    }
}

/// Writes beside the file first: it is whole at any time.
fn replace(output: &Path, text: &str) -> io::Result<()> {
    let mut name = output.file_name().unwrap_or_default().to_owned();
    name.push(".part");
    let beside = output.with_file_name(name);
    fs::write(&beside, text)?;
    fs::rename(&beside, output)
}

fn read(path: &Path) -> Result<String, WorkError> {
    let text = fs::read_to_string(path);
    let text = text.map_err(|source| experiment::ExperimentError::Read {
        path: path.to_owned(),
        source,
    });
    Ok(text?)
}

fn version(text: &str) -> String {
    let digest = Sha256::digest(text.as_bytes());
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}
