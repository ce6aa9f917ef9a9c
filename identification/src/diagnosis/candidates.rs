//! Every effect that the model lacks, tried on the same rows.

use crate::design::{Design, PreparedModel};
use crate::effects::{self, BoundTerm, EffectHandle, Row};
use crate::shape_search::{self, Search, periodicity};
use crate::validation::session_variation::{MIN_SESSIONS, trend};
use crate::validation::{Score, agreement, between, within};

/// p-value below which a coefficient differs within and between sessions.
const MAX_DISAGREEMENT_P_VALUE: f64 = 0.005;

/// Fewest sessions of which one test of the variation between them is enough.
const MIN_SESSIONS_ALONE: usize = 4;

/// Largest p-value of an effect that is suspect.
pub(super) const SUSPECT_MAX_P_VALUE: f64 = 0.1;
/// Smallest share of the mean square that a named effect explains.
pub(super) const MIN_SHARE: f64 = 0.01;
/// Share of the mean square that an effect has to explain on a part of very many rows to be
/// searched on all: half of what it has to, to be named.
const NOTABLE_SHARE: f64 = 0.5 * MIN_SHARE;

/// One effect at its best shape, scored on rows left out.
#[derive(Clone)]
pub struct Candidate {
    /// The effect.
    pub effect: EffectHandle,
    /// Its best shape.
    pub shape: Vec<f64>,
    /// What it explains of rows left out.
    pub score: Score,
    /// Whether its shape, and sign and size of its coefficients, are physically possible.
    pub plausible: bool,
    /// Number of its shapes that were tried.
    pub variants: usize,
}

impl Candidate {
    /// Its effect at its shape, as a term of a model.
    #[must_use]
    pub fn term(&self) -> BoundTerm {
        BoundTerm::new(self.effect.clone(), self.shape.clone())
    }

    /// Id of the effect.
    #[must_use]
    pub fn id(&self) -> &str {
        &self.effect.description().id
    }
}

/// All candidates, and how many variants were tried.
pub struct Trial {
    /// One for each effect, largest gain first.
    pub candidates: Vec<Candidate>,
    /// Number of shapes tried of the effects that show within sessions, for the
    /// correction of p-values.
    pub variants: usize,
    /// The same of the effects that show between sessions.
    pub variants_between: usize,
}

impl Trial {
    /// p-value of one of its candidates, corrected for all that was tried
    /// (weighted Bonferroni): half of the chance of a false alarm is shared out
    /// among effects, half among shapes, so that an effect of one shape does not
    /// pay for the thousand periods that a ripple may have. What shows between
    /// sessions is counted apart: there are few of these.
    #[must_use]
    pub fn corrected(&self, candidate: &Candidate) -> f64 {
        let between = candidate.effect.row().is_between_sessions();
        let p_value = candidate.score.p_value;
        let factor = match between {
            true => self.variants_between as f64,
            false => {
                let effects = self.candidates.iter();
                let effects = effects
                    .filter(|c| !c.effect.row().is_between_sessions())
                    .count();
                let by_effect = 1.0 / (effects * candidate.variants).max(1) as f64;
                let by_shape = 1.0 / self.variants.max(1) as f64;
                2.0 / (by_effect + by_shape)
            }
        };
        (p_value * factor.max(1.0)).min(1.0)
    }
}

/// Effects that the model may lack: those that are neither in it nor a part of
/// one that is.
#[must_use]
pub fn missing(prepared: &PreparedModel) -> Vec<EffectHandle> {
    let has_whole = |part: &Row| {
        let mut own = prepared.terms.iter().map(|t| t.effect.row());
        own.any(|whole| whole.has(part))
    };
    let has_part = |whole: &Row| whole.is_all_parts() && whole.parts().any(|p| prepared.has(p));
    effects::for_subject(prepared.facts.joint.subject())
        .into_iter()
        .chain(prepared.coupling())
        .filter(|effect| {
            let row = effect.row();
            let there = prepared.has(row.id) || has_whole(row) || has_part(row);
            !there && prepared.offers(row) && effect.unavailable(&prepared.facts).is_none()
        })
        .collect()
}

/// Scores one effect at one shape.
#[must_use]
pub fn score(
    prepared: &PreparedModel,
    design: &Design,
    effect: &EffectHandle,
    shape: &[f64],
) -> Score {
    let grams = design.with(&design.extra_columns(prepared, effect, shape));
    // Fewer sessions show no trend over them: what varies within them has to.
    if effect.row().is_between_sessions() && prepared.facts.sessions >= MIN_SESSIONS {
        let mut score = between(design, &grams);
        // A session changes a coefficient by one number, so that the test is a
        // regression line over sessions, not over rows.
        let varied = effect.row().varies;
        let are_enough = prepared.facts.sessions >= MIN_SESSIONS_ALONE;
        match varied.and_then(|id| trend(prepared, design, &grams, id)) {
            // Three leave a line one degree of freedom: the coefficient with one left out in
            // turn has to be suspect, too.
            Some(p) if are_enough || score.p_value < SUSPECT_MAX_P_VALUE => score.p_value = p,
            None if !are_enough => score.p_value = 1.0,
            _ => {}
        }
        // A quantity that also changes within a session must have the same
        // coefficient there, unless it is read too coarsely to tell.
        let of_temperature = effect.row().own_signals.names.contains(&"temperature");
        let tells_within = prepared.temperature_is_resolved || !of_temperature;
        if tells_within && agreement(design, &grams) < MAX_DISAGREEMENT_P_VALUE {
            score.p_value = 1.0;
        }
        score
    } else {
        within(design, &grams)
    }
}

/// Scores the effects of another trial that this model lacks, too, at the shapes found
/// there: no shape is searched.
#[must_use]
pub fn try_again(prepared: &PreparedModel, design: &Design, other: &Trial) -> Trial {
    let mut candidates = Vec::new();
    for effect in missing(prepared) {
        let id = &effect.description().id;
        let Some(known) = other.candidates.iter().find(|own| own.id() == id) else {
            continue;
        };
        let score = score(prepared, design, &effect, &known.shape);
        candidates.push(Candidate {
            plausible: effect.is_possible(&known.shape, &score.coefficients),
            score,
            effect,
            ..known.clone()
        });
    }
    candidates.sort_by(|a, b| b.score.gain.total_cmp(&a.score.gain));
    Trial {
        candidates,
        variants: other.variants,
        variants_between: other.variants_between,
    }
}

/// Tries every effect that the model lacks at its best shape. `progress` is called
/// with the share done, 0 … 1.
#[must_use]
pub fn try_all(prepared: &PreparedModel, design: &Design, progress: &mut dyn FnMut(f64)) -> Trial {
    let effects = missing(prepared);
    let mut trial = Trial {
        candidates: Vec::new(),
        variants: 0,
        variants_between: 0,
    };
    let count = effects.len().max(1) as f64;
    let search = Search::new(prepared, design);
    for (done, effect) in effects.iter().enumerate() {
        let shapes = shape_search::shapes(prepared, design, effect);
        let searched = match effect.row().is_periodic {
            true => periodicity::tried(prepared, effect),
            false => 0,
        };
        let variants = shapes.len() + searched;
        match effect.row().is_between_sessions() {
            true => trial.variants_between += variants,
            false => trial.variants += variants,
        }
        let shape = search.best_if_any(effect, shapes, NOTABLE_SHARE);
        progress((done as f64 + 0.8) / count);
        let Some(shape) = shape else { continue };
        let score = score(prepared, design, effect, &shape);
        let plausible = effect.is_possible(&shape, &score.coefficients);
        trial.candidates.push(Candidate {
            effect: effect.clone(),
            shape,
            score,
            plausible,
            variants,
        });
        progress((done as f64 + 1.0) / count);
    }
    trial
        .candidates
        .sort_by(|a, b| b.score.gain.total_cmp(&a.score.gain));
    trial
}
