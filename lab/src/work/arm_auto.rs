//! Diagnose and add until every joint of an arm is complete, or what is left has no name.

use std::path::{Path, PathBuf};

use ferntast_identification::{Verdict, arm::ArmDiagnosis};
use serde::Serialize;

use super::{AddedToArm, AutoOptions, OpenedArm, WorkError, open_arm, output_of, refuse_existing};

/// No arm has so many effects that these data can tell apart.
const MAX_STEPS: usize = 12;

/// What came of adding what an arm's model lacks, again and again.
#[derive(Debug, Serialize)]
pub struct AutomaticArm {
    /// What was added, in order.
    pub steps: Vec<AddedToArm>,
    /// What is said of the last model.
    pub verdict: Verdict,
    /// The last experiment file.
    pub experiment: PathBuf,
    /// What is left after the last step.
    pub last: ArmDiagnosis,
}

/// What goes on meanwhile.
#[derive(Debug)]
pub enum ArmAutoEvent<'a> {
    /// An experiment was opened, which is diagnosed next.
    Opened(&'a OpenedArm),
    /// So much of its diagnosis is done, 0 … 1.
    Share(f64),
    /// It is diagnosed.
    Diagnosed,
    /// An effect was added to it.
    Added(&'a OpenedArm, &'a AddedToArm),
}

/// Diagnoses the arm's experiment file at `path`, adds the first of what is missing, and so
/// on; `None` where the path leads to an experiment of another kind.
///
/// # Errors
///
/// [`WorkError`]: a file, or one of its recordings, cannot be used, or not written.
pub fn auto_arm(
    path: &Path,
    options: &AutoOptions,
    tell: &mut dyn FnMut(ArmAutoEvent<'_>),
) -> Result<Option<AutomaticArm>, WorkError> {
    let mut path = path.to_owned();
    let mut steps: Vec<AddedToArm> = Vec::new();
    loop {
        let Some(opened) = open_arm(&path)? else {
            return Ok(None);
        };
        options.make_folder()?;
        tell(ArmAutoEvent::Opened(&opened));
        let last = opened.diagnose(&mut |share| tell(ArmAutoEvent::Share(share)))?;
        tell(ArmAutoEvent::Diagnosed);
        let best = last.candidates.first();
        let Some(best) = best.filter(|_| steps.len() < MAX_STEPS) else {
            return Ok(Some(AutomaticArm {
                steps,
                verdict: last.verdict,
                experiment: path,
                last,
            }));
        };
        let term = best.term();
        let output = output_of(&path, &term.to_string(), options.folder.as_deref());
        if !options.force {
            refuse_existing(&output)?;
        }
        let added = opened.add(&term, &output)?;
        path.clone_from(&added.experiment);
        tell(ArmAutoEvent::Added(&opened, &added));
        steps.push(added);
    }
}
