//! Diagnose and add until the model is complete, or what is left has no name.

use std::{
    fs,
    path::{Path, PathBuf},
};

use ferntast_identification::{Diagnosis, Term, Verdict};
use serde::Serialize;

use super::{Added, InUnit, Opened, WorkError, beside, open_file};

/// No joint and no contact has so many effects that these data can tell apart.
const MAX_STEPS: usize = 8;

/// What came of adding what is missing, again and again.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Automatic {
    /// What was added, in order.
    pub steps: Vec<Added>,
    /// What is said of the last model.
    pub verdict: Verdict,
    /// The last experiment file.
    pub experiment: PathBuf,
    /// What is left after the last step.
    pub last: InUnit<Diagnosis>,
}

/// What goes on meanwhile.
#[derive(Debug)]
pub enum AutoEvent<'a> {
    /// An experiment was opened, which is diagnosed next.
    Opened(&'a Opened),
    /// So much of its diagnosis is done, 0 … 1.
    Share(f64),
    /// Its diagnosis.
    Diagnosed(&'a Opened, &'a Diagnosis),
    /// An effect was added to it.
    Added(&'a Opened, &'a Added),
}

/// Diagnoses the experiment file at `path`, adds the first of what is missing, and so
/// on. New experiment files go into `folder`, else beside the old one.
///
/// # Errors
///
/// [`WorkError`]: a file, or one of its recordings, cannot be used, or not written.
pub fn auto(
    path: &Path,
    folder: Option<&Path>,
    tell: &mut dyn FnMut(AutoEvent<'_>),
) -> Result<Automatic, WorkError> {
    if let Some(folder) = folder {
        fs::create_dir_all(folder).map_err(|source| WorkError::File {
            path: folder.to_owned(),
            source,
        })?;
    }
    let mut path = path.to_owned();
    let mut steps: Vec<Added> = Vec::new();
    loop {
        let opened = open_file(&path)?;
        tell(AutoEvent::Opened(&opened));
        let diagnosis = opened.diagnose(&mut |share| tell(AutoEvent::Share(share)))?;
        tell(AutoEvent::Diagnosed(&opened, &diagnosis));
        let best = diagnosis.candidates.first();
        let (Some(best), Verdict::Missing, true) =
            (best, diagnosis.verdict, steps.len() < MAX_STEPS)
        else {
            return Ok(Automatic {
                steps,
                verdict: diagnosis.verdict,
                experiment: path,
                last: opened.in_unit(diagnosis),
            });
        };
        let effect = Term::Catalogue(best.effect.clone());
        let mut output = beside(&path, effect.name());
        if let (Some(folder), Some(name)) = (folder, output.file_name()) {
            output = folder.join(name);
        }
        let added = opened.add(&effect, &output)?;
        tell(AutoEvent::Added(&opened, &added));
        path.clone_from(&added.experiment);
        steps.push(added);
    }
}
