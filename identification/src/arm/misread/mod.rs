//! Joints that are read otherwise than the model has them: the other way round, in another order, a
//! quarter of a turn elsewhere, in another unit.
//!
//! With a torque of the wrong sign anything may look as if it were missing, so that this is asked before
//! effects are. A model of links, inertia of motors, Coulomb and viscous friction, which are not negative,
//! is put to a few samples of all joints read in one way and another; what is read wrongly is
//! told from what is missing by how much it explains.

mod reading;
mod samples;
mod scale;
mod search;

use std::f64::consts::FRAC_PI_2;

use serde::Serialize;

use super::prepared::PreparedArm;
use reading::Reading;
use samples::Samples;

/// A joint of whose torque less than this share is left is read rightly.
const SUSPECT: f64 = 0.15;
/// By how much the logarithms of the joints' errors fall, together, for another reading to be the right
/// one: one error to a third, or several by less.
const MIN_FALL: f64 = 1.1;
/// A joint that was read wrongly has at most this share of its error left: else it is the model that is
/// wrong, of which another reading makes up for something.
const LEFT: f64 = 1.0 / 3.0;

/// A joint that is read otherwise than the model has it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Misread {
    /// Its name in the model.
    pub joint: String,
    /// Its position and its torque count the other way round.
    pub reversed: bool,
    /// Its torque does, or does not where all else is reversed.
    pub torque_reversed: bool,
    /// What has to be added to its position, quarters of a turn \[rad\].
    pub zero: f64,
    /// The joint whose position and torque are read as this one's, in truth.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub is_read_as: Option<String>,
    /// The joint whose torque is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub torque_is_read_as: Option<String>,
    /// What is read as 1 Nm (1 N) of its torque is as much \[Nm\], by the weight of the links as the
    /// URDF has it: it is in another unit, a current, or before the gear.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub torque_of_one: Option<f64>,
    /// RMS of what is left of its torque as it is read \[Nm\].
    pub error_before: f64,
    /// The same read in the other way.
    pub error_after: f64,
}

/// Joints that are read otherwise than the model has them.
pub(super) fn find(arm: &PreparedArm<'_>) -> Vec<Misread> {
    let looked = Samples::new(arm);
    let as_read: Vec<Reading> = (0..looked.joints).map(Reading::plain).collect();
    let before = looked.errors(&as_read);
    let mut sizes = before.iter().zip(&looked.sizes);
    if !sizes.any(|(error, size)| *error > SUSPECT * size) {
        return Vec::new();
    }
    let (gains, is_told) = scale::gains(&looked);
    let (mut looked, mut in_unit) = (looked, before.clone());
    if gains.iter().any(Option::is_some) {
        looked = looked.scaled(&gains);
        // Of the others the unit is not known, so that their errors say nothing.
        looked.counts = is_told;
        in_unit = looked.errors(&as_read);
    }
    let (best, after) = match other_reading(&looked, &as_read, &in_unit) {
        Some(other) => other,
        None => (as_read.clone(), in_unit),
    };
    let name = |at: usize| arm.joint_named(at).0;
    let each = best.iter().zip(&as_read).zip(&gains).enumerate();
    let changed = each.filter(|(_, ((now, then), gain))| now != then || gain.is_some());
    let told = changed.map(|(at, ((now, _), gain))| Misread {
        joint: name(at),
        reversed: now.direction < 0.0,
        torque_reversed: now.direction * now.torque < 0.0,
        zero: signed(now.quarters) * FRAC_PI_2,
        is_read_as: (now.position_of != at).then(|| name(now.position_of)),
        torque_is_read_as: (now.torque_of != at && now.position_of == at)
            .then(|| name(now.torque_of)),
        torque_of_one: *gain,
        error_before: before[at],
        error_after: after[at],
    });
    told.collect()
}

/// The way to read all joints that explains enough more than the one in which `before` is left, and
/// what it leaves.
fn other_reading(
    looked: &Samples<'_>,
    as_read: &[Reading],
    before: &[f64],
) -> Option<(Vec<Reading>, Vec<f64>)> {
    let best = looked.search(as_read);
    if looked.score(&best) > looked.score(as_read) - MIN_FALL {
        return None;
    }
    let after = looked.errors(&best);
    let mut changed = (best.iter().zip(as_read).enumerate()).filter(|(_, (now, then))| now != then);
    let is_mended = |at: usize| {
        // Of a joint that was explained before, too, as of one that the others are turned with, little
        // has to become less.
        let was_explained = before[at] <= SUSPECT * looked.sizes[at];
        after[at] < LEFT * before[at] || (was_explained && after[at] < 1.1 * before[at])
    };
    let is_better = changed.all(|(at, _)| is_mended(at));
    is_better.then_some((best, after))
}

/// Three quarters are one back.
fn signed(quarters: u8) -> f64 {
    match quarters {
        3 => -1.0,
        own => f64::from(own),
    }
}
