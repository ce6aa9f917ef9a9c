//! That each recording counts once: what is fitted twice makes standard errors too small, and
//! what is held out must not have been fitted.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use ferntast_bag::bag_files;

use super::LoadError;
use crate::experiment::Experiment;

/// Refuses a recording that is there twice, under whatever name.
pub(super) fn check(experiment: &Experiment) -> Result<(), LoadError> {
    let fitted = experiment.recordings.iter().chain(&experiment.unloaded);
    let fitted = fitted.map(|path| (path, false));
    let held_out = experiment.held_out.iter().map(|path| (path, true));
    let mut known: BTreeMap<PathBuf, (&Path, bool)> = BTreeMap::new();
    for (path, is_held_out) in fitted.chain(held_out) {
        let files = files_of(path);
        let before = files.iter().find_map(|file| known.get(file));
        match before {
            None => {}
            Some((_, was_held_out)) if *was_held_out != is_held_out => {
                return Err(LoadError::Both { path: path.clone() });
            }
            Some((other, _)) => {
                return Err(LoadError::Twice {
                    path: path.clone(),
                    other: other.to_path_buf(),
                });
            }
        }
        known.extend(files.into_iter().map(|file| (file, (&**path, is_held_out))));
    }
    Ok(())
}

/// The files that a recording is read from, each by the one name that it has: a directory and
/// a file in it may be one recording.
fn files_of(path: &Path) -> Vec<PathBuf> {
    // What cannot be opened is told when it is read.
    let files = match path.is_dir() {
        true => bag_files(path).unwrap_or_default(),
        false => vec![path.to_owned()],
    };
    let files = files.into_iter();
    files
        .map(|file| file.canonicalize().unwrap_or(file))
        .collect()
}
