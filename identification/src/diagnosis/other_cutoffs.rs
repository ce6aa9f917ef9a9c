//! The verdict with another filter.
//!
//! Effects are tried at the shapes that the first search found, so that this takes a
//! fraction of its time.

use super::candidates::Trial;
use super::examination::examine;
use super::results::{Diagnosis, Verdict, VerdictAtCutoff};
use crate::comparison::usage;
use crate::data::{Dataset, ModelSpec};
use crate::preparation::Filtered;

/// The verdict at `factor` times the cut-off of `diagnosis`, whose effects were found
/// by `trial`.
pub(super) fn verdict(
    dataset: &Dataset,
    spec: &ModelSpec,
    trial: &Trial,
    factor: f64,
    diagnosis: &Diagnosis,
) -> VerdictAtCutoff {
    let filtered = Filtered::at_cut_off(dataset, factor);
    let Ok(found) = examine(&filtered, spec, Some(trial), &mut |_| ()) else {
        return VerdictAtCutoff {
            cutoff_hz: diagnosis.used.cutoff_hz * factor,
            share: 0.0,
            verdict: None,
            effect: None,
            agrees: false,
        };
    };
    let used = usage::find(dataset, &found.prepared, &found.design);
    let first = found.passing.first();
    let effect = first.filter(|_| found.verdict == Verdict::Missing);
    let effect = effect.map(|own| own.id().to_owned());
    let same_name = match (&effect, diagnosis.candidates.first()) {
        (Some(name), Some(own)) => own.effect == *name || own.indistinguishable_from.contains(name),
        (name, own) => name.is_none() && own.is_none(),
    };
    VerdictAtCutoff {
        cutoff_hz: used.cutoff_hz,
        share: used.share,
        agrees: found.verdict == diagnosis.verdict && same_name,
        verdict: Some(found.verdict),
        effect,
    }
}
