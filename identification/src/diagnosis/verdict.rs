//! Which candidates pass, and whether the best of them is the answer.

use super::candidates::{Candidate, MIN_SHARE, Trial, try_all};
use super::confirmation::Confirmation;
use super::dependence::{self, Dependence};
use super::equivalents;
use super::results::{Verdict, WhyNot};
use crate::design::{Design, PreparedModel};
use crate::effects::{self, Row};
use crate::preparation::extend;

/// Smallest certainty of its prediction of rows left out, in standard errors.
const MIN_CERTAINTY: f64 = 3.0;
/// Probability of a false alarm over all variants tried that show within a session …
const SIGNIFICANCE: f64 = 0.01;
/// … and over those that show between sessions, of which there are few.
const SIGNIFICANCE_BETWEEN: f64 = 0.012;
/// Smallest share that a free map must explain to count.
const MIN_MAP_SHARE: f64 = 0.03;
/// The shape of a named effect is wrong if a free map over its own signals still
/// explains this share of what both explain.
const MAX_SHAPE_REMAINDER: f64 = 0.13;
/// If free maps explain this share of what name and map explain together, the
/// name is at most a part of the answer …
const MAX_UNNAMED_SHARE: f64 = 0.45;
/// … and so it is if they explain this share,
const NOTABLE_UNNAMED_SHARE: f64 = 0.12;
/// and with it this share of all that the name leaves.
const NOTABLE_SHARE_OF_REST: f64 = 0.6;
/// An effect that explains less than this share of what a map over one signal
/// explains has another shape than what is missing.
const MIN_SHARE_OF_MAP: f64 = 0.92;
/// Effects named on top of each other before the verdict is that they do not
/// explain the residual.
const MAX_NAMED_EFFECTS: usize = 3;

/// Candidates that pass every test, best first.
pub(super) fn passing(trial: &Trial) -> Vec<Candidate> {
    trial
        .candidates
        .iter()
        .filter(|c| passes(c, trial))
        .cloned()
        .collect()
}

fn passes(candidate: &Candidate, trial: &Trial) -> bool {
    candidate.plausible
        && candidate.score.share() > MIN_SHARE
        && (candidate.score.certainty > MIN_CERTAINTY
            || candidate.effect.row().is_between_sessions())
        && trial.corrected(candidate)
            < match candidate.effect.row().is_between_sessions() {
                true => SIGNIFICANCE_BETWEEN,
                false => SIGNIFICANCE,
            }
}

/// Why a candidate that is not named is not.
pub(super) fn why_not(candidate: &Candidate, trial: &Trial) -> WhyNot {
    if !candidate.plausible {
        WhyNot::Implausible
    } else if candidate.score.share() <= MIN_SHARE {
        WhyNot::TooSmall
    } else if !passes(candidate, trial) {
        WhyNot::NotSignificant
    } else {
        WhyNot::NoGain
    }
}

/// Dependences of the residual that count, strongest first.
pub(super) fn maps(prepared: &PreparedModel, design: &Design) -> Vec<Dependence> {
    let mut maps = dependence::find(prepared, design);
    maps.retain(|d| d.strength > MIN_MAP_SHARE);
    maps
}

/// Whether the best candidate is the answer: its shape must be right over its
/// own signals, alone or together with another one of its kind, and it (with others named on
/// top of it) must explain more than free maps explain of the rest.
pub(super) fn judge(
    prepared: &PreparedModel,
    design: &Design,
    passing_first: &[Candidate],
    maps_first: &[Dependence],
    confirmation: &Confirmation,
    progress: &mut dyn FnMut(f64),
) -> Verdict {
    let Some(first) = passing_first.first() else {
        return if maps_first.is_empty() {
            Verdict::Complete
        } else {
            Verdict::Unexplained
        };
    };
    let most_by_one = maps_first
        .iter()
        .filter(|map| map.signals.len() == 1)
        .fold(0.0, |most, map| f64::max(most, map.gain));
    let mut named = 0.0;
    let mut best = first.clone();
    let mut left = design.own_mean_square();
    let mut prepared = extend(prepared, best.term());
    for step in 0..MAX_NAMED_EFFECTS {
        let design = Design::new(&prepared);
        let own = dependence::on_own_signals(&prepared, &design, &best.effect);
        let id = best.id().to_owned();
        let lacks_shape = own > MAX_SHAPE_REMAINDER * (own + best.score.gain);
        let is_another = |row: &Row| row.another == Some(&id);
        if lacks_shape && effects::find_by_row(is_another).is_none() {
            break;
        }
        let before = std::mem::replace(&mut left, design.own_mean_square());
        named += match best.effect.row().acts_on_channels {
            // It was tried by a line of what it does, which tells less than all of it.
            true => f64::max(best.score.gain, before - left),
            false => best.score.gain,
        };
        let (unnamed, of_rest) = maps(&prepared, &design)
            .iter()
            .find(|own| confirmation.has_map(own))
            .map_or((0.0, 0.0), |d| (d.gain, d.strength));
        let share = unnamed / (unnamed + named).max(1e-300);
        progress((step as f64 + 1.0) / MAX_NAMED_EFFECTS as f64);
        let notable = share > NOTABLE_UNNAMED_SHARE && of_rest > NOTABLE_SHARE_OF_REST;
        let has_shape = named >= MIN_SHARE_OF_MAP * most_by_one;
        if !lacks_shape && share <= MAX_UNNAMED_SHARE && !notable && has_shape {
            return Verdict::Missing;
        }
        let trial = try_all(&prepared, &design, &mut |_| ());
        let mut next = passing(&trial);
        next.retain(|own| confirmation.has(own));
        if lacks_shape {
            next.retain(|own| is_another(own.effect.row()));
        }
        equivalents::order(&design, &mut next);
        let Some(candidate) = next.into_iter().next() else {
            break;
        };
        best = candidate;
        prepared = extend(&prepared, best.term());
    }
    Verdict::Unexplained
}
