//! What noise of the acceleration may look like, looked for with a slower filter as well.
//!
//! Where the position is coarse, J q̈ has noise that is in the residual, and everything that is made of
//! the same position can tell some of it on rows left out, too: a delay, as it filters once more, and
//! a map over acceleration, or over a load that is modelled by it. The noise of q̈ falls with the
//! cut-off to the power of 5 in square, what is there in the motion hardly falls: so these count
//! only where they are found at half the cut-off, too. The same goes for formulas over such signals
//! (`discovery::slower`).

use std::ops::Range;

use super::candidates::{Candidate, MIN_SHARE, Trial};
use super::dependence::Dependence;
use super::examination::{Examination, examine};
use crate::data::ModelSpec;
use crate::design::PreparedModel;
use crate::preparation::Filtered;

/// The cut-off of the slower filter, as a ratio to that of the other.
pub(crate) const FACTOR: f64 = 0.5;
/// Probability of finding there by chance what was found before.
const SIGNIFICANCE: f64 = 0.05;
/// Ratio of two coefficients that are the same.
const SAME_SIZE: Range<f64> = 0.5..2.0;

/// What is found with the slower filter; `None` where nothing had to be looked for.
pub(super) struct Confirmation {
    signals: Vec<String>,
    slower: Option<Box<Examination>>,
}

impl Confirmation {
    /// Nothing is in doubt.
    pub(super) const NONE: Confirmation = Confirmation {
        signals: Vec::new(),
        slower: None,
    };

    /// Looks again for what of `passing` and `maps`, found by `trial`, may be noise.
    pub(super) fn of(
        filtered: &Filtered<'_>,
        spec: &ModelSpec,
        prepared: &PreparedModel,
        trial: &Trial,
        passing: &[Candidate],
        maps: &[Dependence],
    ) -> Confirmation {
        let mut own = Confirmation {
            signals: noisy_signals(prepared),
            slower: None,
        };
        let doubtful = passing.iter().any(is_doubtful) || maps.iter().any(|map| own.doubts(map));
        if doubtful {
            let slower = examine(&filtered.at_factor(FACTOR), spec, Some(trial), &mut |_| ());
            // A recording that is too short for the slower filter tells nothing against it.
            own.slower = slower.ok().map(Box::new);
        }
        own
    }

    /// Leaves of `passing`, best first, those that count. Where the best may be noise, so may what
    /// would take its place: the others, too, have to be found with the slower filter then.
    pub(super) fn keep(&self, passing: &mut Vec<Candidate>) {
        match passing.first().is_none_or(|best| self.has(best)) {
            true => passing.retain(|own| self.has(own)),
            false => passing.retain(|own| self.finds(own)),
        }
    }

    /// Whether a candidate counts.
    pub(super) fn has(&self, candidate: &Candidate) -> bool {
        !is_doubtful(candidate) || self.finds(candidate)
    }

    /// Whether a candidate is found with the slower filter, too, or that tells nothing.
    fn finds(&self, candidate: &Candidate) -> bool {
        let Some(slower) = &self.slower else {
            return true;
        };
        let mut tried = slower.trial.candidates.iter();
        tried.any(|again| again.id() == candidate.id() && confirms(again, candidate))
    }

    /// Whether a dependence counts.
    pub(super) fn has_map(&self, map: &Dependence) -> bool {
        let Some(slower) = &self.slower else {
            return true;
        };
        // What is over some of its signals is over all of them, too; a modelled load and the
        // acceleration are nearly one.
        let all_in_doubt = map
            .signals
            .iter()
            .all(|signal| self.signals.contains(signal));
        let is_part = |other: &Dependence| {
            let mut signals = other.signals.iter();
            let within = signals.all(|signal| map.signals.contains(signal));
            within && self.doubts(other) && !(all_in_doubt && other.signals.len() > 1)
        };
        !self.doubts(map) || slower.maps.iter().any(is_part)
    }

    fn doubts(&self, map: &Dependence) -> bool {
        map.signals
            .iter()
            .any(|signal| self.signals.contains(signal))
    }
}

/// Names of the signals that have noise of the acceleration, as results name them.
pub(crate) fn noisy_signals(prepared: &PreparedModel) -> Vec<String> {
    let facts = &prepared.facts;
    let modelled: &[&str] = match facts.joint_torque {
        true => &[],
        false => &["load", "load_rate"],
    };
    let all = ["acceleration"].iter().chain(modelled);
    all.map(|name| facts.joint.signal(name).to_owned())
        .collect()
}

fn is_doubtful(candidate: &Candidate) -> bool {
    candidate.effect.row().is_lateness
}

/// Whether what is found `again` is the same, of about the same size. How much it helps is told
/// with the filter that is used; it is the only one that is asked for here, at the shape that is
/// known, so that its p-value is that of one test.
fn confirms(again: &Candidate, found: &Candidate) -> bool {
    let mut sizes = again
        .score
        .coefficients
        .iter()
        .zip(&found.score.coefficients);
    again.plausible
        && again.score.share() > MIN_SHARE
        && again.score.p_value < SIGNIFICANCE
        && sizes.all(|(again, found)| SAME_SIZE.contains(&(again / found)))
}
