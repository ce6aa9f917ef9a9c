//! What shows just after reversals, where the rows of the regression are left
//! out: there it is looked for.
//!
//! A tip that rests until what carries it has wound up (the paper's Fig. 16)
//! does so over a travel that may be shorter than what is left out.

use crate::candidates::{Candidate, missing, score};
use crate::design::Design;
use crate::refine;
use crate::setup::Setup;
use crate::validation::left_out;

/// It explains this share of what all rows leave; what else happens at turns
/// (the sign of a velocity that is hardly known) does not.
const LEAST_SHARE: f64 = 0.5;
/// Standard errors by which its prediction of rows left out is right.
const LEAST_CERTAINTY: f64 = 4.0;
/// Chance of a false alarm.
const SIGNIFICANCE: f64 = 1e-4;

/// An effect that shows at turns is looked for there. Where it is there, and
/// explains more of all rows than what is named first, it comes first.
pub fn settle(setup: &Setup, design: &Design, passing: &mut Vec<Candidate>) {
    let Some(effect) = missing(setup).into_iter().find(|e| e.row().shows_at_turns) else {
        return;
    };
    let whole = setup.with_reversals();
    let all_rows = Design::new(&whole);
    let Some(shape) = refine::search(&whole, &all_rows, &effect) else {
        return;
    };
    let (there, _) = score(&whole, &all_rows, &effect, &shape);
    let is_there = effect.plausible(&shape, &there.coefficients)
        && there.share() > LEAST_SHARE
        && there.certainty > LEAST_CERTAINTY
        && there.p_value < SIGNIFICANCE;
    let rival = passing.first().map_or(0.0, |first| {
        score(&whole, &all_rows, &first.effect, &first.shape).0.gain
    });
    if !is_there || there.gain <= rival {
        return;
    }
    // What is said of it is reported on the same rows as of all others, but that it
    // is there is proven by all rows. Away from turns there may be nothing of it.
    let (mut own, grams) = score(setup, design, &effect, &shape);
    own.gain = own.gain.max(0.0);
    own.p_value = there.p_value;
    passing.retain(|other| other.id() != effect.description().id);
    passing.insert(
        0,
        Candidate {
            left_out: left_out(design, &grams),
            variants: refine::grid(&whole, &effect).len(),
            effect,
            shape,
            score: own,
            plausible: true,
        },
    );
}
