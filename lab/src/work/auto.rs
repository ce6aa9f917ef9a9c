//! Diagnose and add until the model is complete, or what is left has no name.

use std::{
    fs,
    path::{Path, PathBuf},
};

use ferntast_identification::{Diagnosis, Term, Verdict, diagnosis::NamedCandidate};
use serde::Serialize;

use super::{Added, InUnit, Opened, WorkError, open_file, output_of, refuse_existing};

/// No joint and no contact has so many effects that these data can tell apart.
const MAX_STEPS: usize = 8;

/// How far it goes, and where results go.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct AutoOptions {
    /// Folder of the new experiment files, else beside the old one.
    pub folder: Option<PathBuf>,
    /// Also take effects that help in part, where nothing explains the rest.
    pub partial: bool,
    /// Leave out the last verdict at other cut-offs of the filter.
    pub quick: bool,
    /// Write over files that are there.
    pub force: bool,
}

impl AutoOptions {
    pub(super) fn make_folder(&self) -> Result<(), WorkError> {
        let Some(folder) = &self.folder else {
            return Ok(());
        };
        fs::create_dir_all(folder).map_err(|source| WorkError::File {
            path: folder.clone(),
            source,
        })
    }
}

/// What came of adding what is missing, again and again.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Automatic {
    /// What was added, in order.
    pub steps: Vec<Step>,
    /// What is said of the last model.
    pub verdict: Verdict,
    /// The last experiment file.
    pub experiment: PathBuf,
    /// What is left after the last step.
    pub last: InUnit<Diagnosis>,
}

/// One effect more.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Step {
    /// The effect, and how far the error fell.
    #[serde(flatten)]
    pub added: Added,
    /// Whether it only takes a part of what nothing explains.
    pub in_part: bool,
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
    Added(&'a Opened, &'a Step),
}

/// What is added next, and whether it only helps in part.
fn next(diagnosis: &Diagnosis, partial: bool) -> Option<(String, bool)> {
    let first = |of: &[NamedCandidate]| of.first().map(|own| own.effect.clone());
    match diagnosis.verdict {
        Verdict::Missing => Some((first(&diagnosis.candidates)?, false)),
        Verdict::Unexplained if partial => Some((first(&diagnosis.helps_in_part)?, true)),
        _ => None,
    }
}

/// Diagnoses the experiment file at `path`, adds the first of what is missing, and so on.
///
/// # Errors
///
/// [`WorkError`]: a file, or one of its recordings, cannot be used, or not written.
pub fn auto(
    path: &Path,
    options: &AutoOptions,
    tell: &mut dyn FnMut(AutoEvent<'_>),
) -> Result<Automatic, WorkError> {
    options.make_folder()?;
    let mut path = path.to_owned();
    let mut steps: Vec<Step> = Vec::new();
    loop {
        let opened = open_file(&path)?;
        tell(AutoEvent::Opened(&opened));
        let diagnosis = opened.diagnose(&mut |share| tell(AutoEvent::Share(share)))?;
        tell(AutoEvent::Diagnosed(&opened, &diagnosis));
        let best = next(&diagnosis, options.partial);
        let Some((name, in_part)) = best.filter(|_| steps.len() < MAX_STEPS) else {
            let last = match options.quick {
                true => diagnosis,
                false => opened.diagnose_at_cutoffs(&mut |_| {})?,
            };
            return Ok(Automatic {
                steps,
                verdict: last.verdict,
                experiment: path,
                last: opened.in_unit(last),
            });
        };
        let effect = Term::Catalogue(name);
        let output = output_of(&path, effect.name(), options.folder.as_deref());
        if !options.force {
            refuse_existing(&output)?;
        }
        let added = opened.add(&effect, &output)?;
        path.clone_from(&added.experiment);
        let step = Step { added, in_part };
        tell(AutoEvent::Added(&opened, &step));
        steps.push(step);
    }
}
