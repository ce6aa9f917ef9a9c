//! What noise of the acceleration may look like, looked for with a slower filter as well.
//!
//! Where the position is coarse, J q̈ has noise that is in the residual, and everything that is made of
//! the same position can tell some of it on rows left out, too: a delay, as it filters once more, and
//! a map over acceleration, or over a load that is modelled by it. The noise of q̈ falls with the
//! cut-off to the power of 5 in square, what is there in the motion hardly falls: so these count
//! only where they are found at half the cut-off, too.

use super::candidates::{Candidate, Trial};
use super::dependence::Dependence;
use super::examination::{Examination, examine};
use super::verdict::passing;
use crate::data::ModelSpec;
use crate::design::PreparedModel;
use crate::effects::CHANNEL_DELAY;
use crate::preparation::Filtered;

/// How much slower the other filter is.
const FACTOR: f64 = 0.5;

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
            signals: signals(prepared),
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

    /// Whether a candidate counts.
    pub(super) fn has(&self, candidate: &Candidate) -> bool {
        let Some(slower) = &self.slower else {
            return true;
        };
        // That it is there is enough: how much it helps is told with the filter that is used.
        let same = |other: &Candidate| other.id() == candidate.id();
        !is_doubtful(candidate) || passing(&slower.trial).iter().any(same)
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

/// Signals that have noise of the acceleration.
fn signals(prepared: &PreparedModel) -> Vec<String> {
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
    candidate.id() == CHANNEL_DELAY
}
