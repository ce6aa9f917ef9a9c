//! What a candidate does to the error that is reported: it is no name unless it
//! lowers that.
//!
//! Other tests tell whether an effect is there; session by session, with parameters
//! of its own for each, they see effects that are smaller than the variation from
//! session to session. Whether it helps is told by the model with it, bound to
//! the recordings and fitted anew as when it is added.

use std::collections::BTreeMap;

use super::candidates::Candidate;
use crate::comparison::noise_floor;
use crate::data::{ModelSpec, Term};
use crate::design::{Design, PreparedModel};
use crate::effects::EffectHandle;
use crate::fit::Fit;
use crate::fit::addition::{Addition, add_to};
use crate::preparation::Filtered;

/// Additions of candidates, by their ids; made once.
pub struct Acceptance<'a> {
    pub filtered: &'a Filtered<'a>,
    pub spec: &'a ModelSpec,
    pub prepared: &'a PreparedModel,
    pub base: &'a Fit,
    /// Whether shapes are those of another trial, and stay.
    pub keeps_shapes: bool,
    pub made: BTreeMap<String, Option<Addition>>,
}

impl Acceptance<'_> {
    /// The model with the candidate, where that lowers the error.
    pub fn of(&mut self, candidate: &Candidate) -> Option<&Addition> {
        let id = candidate.id();
        if !self.made.contains_key(id) {
            let made = self.add(candidate);
            self.made.insert(id.to_owned(), made);
        }
        self.made.get(id)?.as_ref()
    }

    /// Leaves out of `passing` what does not lower the error.
    pub fn keep_accepted(&mut self, passing: &mut Vec<Candidate>) {
        passing.retain(|candidate| self.of(candidate).is_some());
    }

    /// Whether a search in the model with the candidate would go through the same columns and
    /// rows as that of the trial: where neither depends on a load that is modelled, on a
    /// prediction, or on other shapes.
    fn would_be_found_again(&self, candidate: &Candidate) -> bool {
        let has_load = self.prepared.facts.joint_torque;
        let is_fixed = |effect: &EffectHandle| {
            let row = effect.row();
            let stays = effect.is_of_motion() || has_load;
            stays && !row.needs_prediction && !row.acts_on_channels
        };
        let mut terms = self.prepared.terms.iter();
        let same_rows = !candidate.effect.row().shows_at_reversals || self.prepared.reversals;
        same_rows
            && is_fixed(&candidate.effect)
            && terms.all(|term| is_fixed(&term.effect) && term.shape.is_empty())
    }

    fn add(&self, candidate: &Candidate) -> Option<Addition> {
        let term = Term::Catalogue(candidate.id().to_owned());
        let both = (self.prepared, self.base);
        let known = self.keeps_shapes || self.would_be_found_again(candidate);
        let shape = known.then_some(candidate.shape.as_slice());
        let (addition, extended) = add_to(self.filtered, self.spec, both, &term, shape).ok()?;
        let is_no_limit = has_too_many_beyond(&extended);
        let is_refused = is_no_limit || is_below_noise(&addition, &extended);
        (addition.lowers_error && !is_refused).then_some(addition)
    }
}

/// Whether too many samples are beyond a limit of torque, by an effect of the model: what is
/// measured there tells nothing of it.
fn has_too_many_beyond(extended: &PreparedModel) -> bool {
    let sessions = &extended.sessions;
    let all: usize = sessions.iter().map(|own| own.points.len()).sum();
    extended.terms.iter().any(|term| {
        let each = sessions.iter();
        let beyond = each.map(|own| term.effect.unjudged_samples(&term.shape, &own.points).len());
        beyond.sum::<usize>() as f64 > term.effect.most_unjudged(&term.shape) * all as f64
    })
}

/// Whether the error is less than the noise between repeats, as it is where torque
/// explains itself.
fn is_below_noise(addition: &Addition, extended: &PreparedModel) -> bool {
    if addition.judged_share >= 1.0 {
        return false;
    }
    let noise = noise_floor::find(extended, &Design::new(extended));
    (noise.repeats).is_some_and(|repeats| addition.held_out_after < repeats)
}
