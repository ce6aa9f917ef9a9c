//! Repairing recordings that were cut off or damaged.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use serde::Serialize;

use super::{
    copy::{copy, join},
    directory::{are_one_recording, bag_directory, bag_files, bag_files_anyhow},
    error::{FinishBagError, RepairError},
    info::Break,
    layout::Layout,
    metadata::{BagMetadata, METADATA_FILE},
    writer::write_metadata,
};

/// What a repair did.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct RepairReport {
    /// Where the whole recording is now.
    pub path: PathBuf,
    /// Its files.
    pub files: Vec<RepairedFile>,
    /// Messages in all files.
    pub messages: u64,
    /// Whether `metadata.yaml` was written.
    pub metadata_written: bool,
}

/// One MCAP file of a repair.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct RepairedFile {
    /// The whole file.
    pub path: PathBuf,
    /// Where the broken one is kept, when it was replaced.
    pub backup: Option<PathBuf>,
    /// Messages in it: all that could be recovered.
    pub messages: u64,
    /// Where it was broken; empty for a file that was whole.
    pub breaks: Vec<Break>,
}

/// Repairs the MCAP file or rosbag2 directory at `path`: what can be read is
/// written into a whole file, with `metadata.yaml` for a rosbag2 directory or
/// a file in one.
///
/// With `output` the result goes there and `path` stays as it is. Without, a
/// broken file is replaced by the whole one once that is written, and kept
/// beside it with `.broken` behind its name; files that are whole stay as
/// they are.
///
/// # Errors
///
/// [`RepairError`]; the original is then as it was.
pub fn repair(path: &Path, output: Option<&Path>) -> Result<RepairReport, RepairError> {
    if path.is_dir() {
        let files = bag_files_anyhow(path)?;
        if !path.join(METADATA_FILE).exists() && !are_one_recording(&files) {
            return Err(RepairError::Unrelated {
                path: path.to_owned(),
                files: files.len(),
                first: file_name(&files[0]),
            });
        }
        let target = output.unwrap_or(path);
        if let Some(output) = output {
            begin_output(output)?;
        }
        let sources: Vec<_> = files
            .into_iter()
            .map(|file| {
                let target = target.join(file_name(&file));
                (file, target)
            })
            .collect();
        return repair_bag(&sources, target, output.is_none());
    }
    let target = output.unwrap_or(path);
    if output.is_some() && target.exists() {
        return Err(RepairError::OutputExists {
            path: target.to_owned(),
        });
    }
    if let (Some(directory), None) = (bag_directory(path), output) {
        let mut sources: Vec<_> = bag_files_anyhow(&directory)?
            .into_iter()
            .map(|file| (file.clone(), file))
            .collect();
        if sources
            .iter()
            .any(|(file, _)| file.file_name() == path.file_name())
        {
            sources.sort();
            let mut report = repair_bag(&sources, &directory, true)?;
            path.clone_into(&mut report.path);
            return Ok(report);
        }
    }
    let repaired = repair_file(path, target, output.is_none())?;
    Ok(RepairReport {
        path: target.to_owned(),
        messages: repaired.file.messages,
        files: vec![repaired.file],
        metadata_written: false,
    })
}

fn file_name(file: &Path) -> PathBuf {
    file.file_name().map(PathBuf::from).unwrap_or_default()
}

fn begin_output(output: &Path) -> Result<(), RepairError> {
    fs::create_dir_all(output).map_err(|error| write_error(output, &error))?;
    match fs::read_dir(output).map(|mut entries| entries.next().is_none()) {
        Ok(true) => Ok(()),
        Ok(false) => Err(RepairError::OutputExists {
            path: output.to_owned(),
        }),
        Err(error) => Err(write_error(output, &error)),
    }
}

fn repair_bag(
    sources: &[(PathBuf, PathBuf)],
    directory: &Path,
    in_place: bool,
) -> Result<RepairReport, RepairError> {
    let mut repaired = Vec::new();
    for (source, target) in sources {
        repaired.push(repair_file(source, target, in_place)?);
    }
    let changed = repaired.iter().any(|one| !one.file.breaks.is_empty());
    let readable = bag_files(directory).is_ok() && directory.join(METADATA_FILE).exists();
    let metadata_written = changed || !readable || !in_place;
    if metadata_written {
        let metadata = repaired
            .iter()
            .map(|one| one.metadata.clone())
            .reduce(join)
            .unwrap_or_default();
        write_metadata(directory, &metadata).map_err(|error| match error {
            FinishBagError::Metadata { path, source } => write_error(&path, &source),
            error => RepairError::Write {
                path: directory.to_owned(),
                reason: error.to_string(),
            },
        })?;
    }
    Ok(RepairReport {
        path: directory.to_owned(),
        messages: repaired.iter().map(|one| one.file.messages).sum(),
        files: repaired.into_iter().map(|one| one.file).collect(),
        metadata_written,
    })
}

/// A file that is whole now.
struct RepairOutcome {
    file: RepairedFile,
    metadata: BagMetadata,
}

/// Writes what can be read of `source` to `target`. In place, a file that is
/// whole is left alone.
fn repair_file(source: &Path, target: &Path, in_place: bool) -> Result<RepairOutcome, RepairError> {
    let layout = Layout::salvage(source)?;
    let part = with_suffix(target, ".part")?;
    let written = copy(&layout, target, &part);
    let (breaks, metadata) = match written {
        Ok(written) => written,
        Err(error) => {
            let _ = fs::remove_file(&part);
            return Err(RepairError::Write {
                path: part,
                reason: error.to_string(),
            });
        }
    };
    let mut backup = None;
    if in_place && breaks.is_empty() {
        fs::remove_file(&part).map_err(|error| write_error(&part, &error))?;
    } else {
        if in_place {
            let kept = free_name(source)?;
            fs::rename(source, &kept).map_err(|error| write_error(&kept, &error))?;
            backup = Some(kept);
        }
        fs::rename(&part, target).map_err(|error| write_error(target, &error))?;
    }
    Ok(RepairOutcome {
        file: RepairedFile {
            path: target.to_owned(),
            backup,
            messages: metadata.files.iter().map(|file| file.messages).sum(),
            breaks,
        },
        metadata,
    })
}

fn with_suffix(path: &Path, suffix: &str) -> Result<PathBuf, RepairError> {
    match path.file_name().and_then(|name| name.to_str()) {
        Some(name) => Ok(path.with_file_name(format!("{name}{suffix}"))),
        None => Err(RepairError::NoName {
            path: path.to_owned(),
        }),
    }
}

/// A name for the broken file that is not taken: an earlier repair's backup
/// is not written over.
fn free_name(path: &Path) -> Result<PathBuf, RepairError> {
    let mut name = with_suffix(path, ".broken")?;
    let mut number = 2;
    while name.exists() {
        name = with_suffix(path, &format!(".broken_{number}"))?;
        number += 1;
    }
    Ok(name)
}

fn write_error(path: &Path, error: &io::Error) -> RepairError {
    RepairError::Write {
        path: path.to_owned(),
        reason: error.to_string(),
    }
}
