//! The files of a rosbag2 directory.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use super::{
    error::OpenBagError,
    metadata::{FileList, METADATA_FILE},
};

/// The MCAP files of the recording at `path`, in order: those of a rosbag2 directory, or the
/// one file that it is.
///
/// # Errors
///
/// [`OpenBagError`]: nothing is there, or its `metadata.yaml` is broken.
pub fn bag_files(path: &Path) -> Result<Vec<PathBuf>, OpenBagError> {
    if !fs::metadata(path)
        .map_err(|error| io_error(path, &error))?
        .is_dir()
    {
        return Ok(vec![path.to_owned()]);
    }
    let metadata = path.join(METADATA_FILE);
    match fs::read(&metadata) {
        Ok(bytes) => {
            let names = FileList::parse(&String::from_utf8_lossy(&bytes)).map_err(|reason| {
                OpenBagError::Metadata {
                    path: metadata,
                    reason,
                }
            })?;
            Ok(names.iter().map(|name| path.join(name)).collect())
        }
        // Killed before it was closed: its files may still be whole.
        Err(error) if error.kind() == io::ErrorKind::NotFound => found_files(path),
        Err(error) => Err(io_error(&metadata, &error)),
    }
}

/// The same for repair: what a broken `metadata.yaml` says does not count.
pub(crate) fn bag_files_anyhow(directory: &Path) -> Result<Vec<PathBuf>, OpenBagError> {
    match bag_files(directory) {
        Err(OpenBagError::Metadata { .. }) => found_files(directory),
        files => files,
    }
}

/// The MCAP files that stand in `directory`, name_2 before name_10.
fn found_files(directory: &Path) -> Result<Vec<PathBuf>, OpenBagError> {
    let mut files = Vec::new();
    for entry in fs::read_dir(directory).map_err(|error| io_error(directory, &error))? {
        let file = entry.map_err(|error| io_error(directory, &error))?.path();
        if file
            .extension()
            .is_some_and(|extension| extension == "mcap")
        {
            files.push(file);
        }
    }
    files.sort_by_key(|file| (file.as_os_str().len(), file.clone()));
    if files.is_empty() {
        return Err(OpenBagError::NoRecording {
            path: directory.to_owned(),
        });
    }
    Ok(files)
}

/// Whether files are those of one recording by their names: `NAME_0.mcap`, `NAME_1.mcap`, …, or a
/// single file of any name.
pub(crate) fn are_one_recording(files: &[PathBuf]) -> bool {
    let name = |file: &PathBuf| {
        let stem = file.file_stem()?.to_str()?;
        let (name, number) = stem.rsplit_once('_')?;
        is_number(number).then(|| name.to_owned())
    };
    match files {
        [] | [_] => true,
        [first, rest @ ..] => {
            let first = name(first);
            first.is_some() && rest.iter().all(|file| name(file) == first)
        }
    }
}

fn is_number(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
}

/// The rosbag2 directory that a file stands in: one with `metadata.yaml`, or
/// of the name that the file has in front of its number.
pub(crate) fn bag_directory(file: &Path) -> Option<PathBuf> {
    let directory = match file.parent()? {
        // A bare file name.
        parent if parent.as_os_str().is_empty() => Path::new("."),
        parent => parent,
    };
    let real = fs::canonicalize(directory).ok()?;
    let stem = file.file_stem()?.to_str()?;
    let number = real
        .file_name()
        .and_then(|name| stem.strip_prefix(name.to_str()?)?.strip_prefix('_'));
    (number.is_some_and(is_number) || directory.join(METADATA_FILE).exists())
        .then(|| directory.to_owned())
}

fn io_error(path: &Path, error: &io::Error) -> OpenBagError {
    match error.kind() {
        io::ErrorKind::NotFound => OpenBagError::Missing {
            path: path.to_owned(),
        },
        _ => OpenBagError::Io {
            path: path.to_owned(),
            reason: error.to_string(),
        },
    }
}
