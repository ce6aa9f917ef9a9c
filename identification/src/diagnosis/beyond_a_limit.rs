//! A limit of drive or sensor, or what else makes large torques look wrong.
//!
//! Beyond a limit the measured torque explains itself and nothing is judged, so that a limit gains
//! more than what has to explain these samples. Friction by load, too, shows where torques are large.
//! An effect beside which the limit adds nothing certain goes before it.

use super::candidates::Candidate;
use super::encompassing_test::{MAX_P_VALUE_ADDING, p_value_beside};
use super::equivalents;
use crate::design::{Design, PreparedModel};

/// Puts the best of such effects first of those that are `passing`, which are ordered.
pub(super) fn put_behind(prepared: &PreparedModel, design: &Design, passing: &mut Vec<Candidate>) {
    let Some(first) = passing.first().cloned() else {
        return;
    };
    if !leaves_samples_out(prepared, &first) {
        return;
    }
    let explains_it = |rival: &Candidate| {
        !rival.effect.row().is_between_sessions()
            && p_value_beside(prepared, design, rival, &first.effect, &first.shape)
                > MAX_P_VALUE_ADDING
    };
    if passing.iter().skip(1).any(explains_it) {
        passing.remove(0);
        equivalents::order(design, passing);
        passing.insert(1, first);
    }
}

fn leaves_samples_out(prepared: &PreparedModel, candidate: &Candidate) -> bool {
    let mut sessions = prepared.sessions.iter();
    sessions.any(|own| {
        let left_out = candidate
            .effect
            .unjudged_samples(&candidate.shape, &own.points);
        !left_out.is_empty()
    })
}
