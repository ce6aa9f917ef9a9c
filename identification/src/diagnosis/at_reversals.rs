//! An effect that shows only just after reversals, where the rows of the
//! regression are left out, is searched in all rows.
//!
//! A tip that rests until the compliance behind it has wound up (the paper's
//! Fig. 16) does so over a travel that may be shorter than what is left out. The same goes for a
//! joint whose load comes off the teeth as it turns back.

use super::candidates::{Candidate, missing, score};
use crate::data::Subject;
use crate::design::{Design, PreparedModel};
use crate::effects::EffectHandle;
use crate::shape_search;

/// Smallest share of the mean square over all rows that an effect of a contact explains; other
/// influences at reversals (the uncertain sign of a velocity near zero) explain less.
const MIN_SHARE_OF_CONTACT: f64 = 0.5;
/// The same of an effect of a joint, which has to be there away from reversals, too.
const MIN_SHARE_OF_JOINT: f64 = 0.3;
/// Smallest certainty of its prediction of rows left out, in standard errors.
const MIN_CERTAINTY: f64 = 4.0;
/// Probability of a false alarm.
const SIGNIFICANCE: f64 = 1e-4;
/// Smallest share of the mean square away from reversals that an effect of a joint explains, and
/// largest p-value there.
const MIN_SHARE_AWAY: f64 = 0.1;
const MAX_P_VALUE_AWAY: f64 = 0.01;
/// Share of the mean square away from reversals, with what rings there, that an effect of a joint
/// explains where it is worth a search in all rows.
const MIN_SHARE_TRIED: f64 = 0.05;

/// Puts an effect that shows at reversals first in `passing`, where it is
/// significant on all rows and explains more of them than the first does. `tried` are all
/// candidates, away from reversals.
pub fn put_first(
    prepared: &PreparedModel,
    design: &Design,
    passing: &mut Vec<Candidate>,
    tried: &[Candidate],
) {
    let Some(effect) = missing(prepared)
        .into_iter()
        .find(|e| e.row().shows_at_reversals)
    else {
        return;
    };
    let is_of_joint = effect.row().of == Subject::Joint;
    let explains = |own: &Candidate| {
        own.id() == effect.description().id && own.score.share() > MIN_SHARE_TRIED
    };
    if is_of_joint && !tried.iter().any(explains) {
        return;
    }
    let whole = prepared.with_reversals();
    let all_rows = Design::new(&whole);
    let Some(shape) = shape_search::search(&whole, &all_rows, &effect) else {
        return;
    };
    // Samples at which its torque is not determined tell nothing of it.
    let whole = whole.without_undetermined(&effect, &shape);
    let all_rows = Design::new(&whole);
    let on_all_rows = score(&whole, &all_rows, &effect, &shape);
    let min_share = match is_of_joint {
        true => MIN_SHARE_OF_JOINT,
        false => MIN_SHARE_OF_CONTACT,
    };
    let is_significant = effect.is_possible(&shape, &on_all_rows.coefficients)
        && on_all_rows.share() > min_share
        && on_all_rows.certainty > MIN_CERTAINTY
        && on_all_rows.p_value < SIGNIFICANCE
        && (!is_of_joint || is_there_away(prepared, &effect, &shape));
    let rival = passing.first().map_or(0.0, |first| {
        score(&whole, &all_rows, &first.effect, &first.shape).gain
    });
    if !is_significant || on_all_rows.gain <= rival {
        return;
    }
    // Its gain is reported on the same rows as that of all others, its p-value on all
    // rows, which prove it. Away from reversals its gain may be zero.
    let mut own = score(prepared, design, &effect, &shape);
    own.gain = own.gain.max(0.0);
    own.p_value = on_all_rows.p_value;
    passing.retain(|other| other.id() != effect.description().id);
    passing.insert(
        0,
        Candidate {
            variants: shape_search::grid(&whole, &effect).len(),
            effect,
            shape,
            score: own,
            plausible: true,
        },
    );
}

/// Whether an effect of a joint explains something away from reversals, too, as what a gap does
/// begins before them; the uncertain sign of a velocity near zero does not.
fn is_there_away(prepared: &PreparedModel, effect: &EffectHandle, shape: &[f64]) -> bool {
    let sliding = prepared.clone().without_undetermined(effect, shape);
    let score = score(&sliding, &Design::new(&sliding), effect, shape);
    score.share() > MIN_SHARE_AWAY && score.p_value < MAX_P_VALUE_AWAY
}
