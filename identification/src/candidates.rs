//! Every effect that the model lacks, tried on the same rows.

use crate::design::{BlockGrams, Design};
use crate::effects::{self, EffectHandle, Row};
use crate::periodic;
use crate::refine;
use crate::scatter::trend;
use crate::setup::Setup;
use crate::validation::{Score, agreement, between, left_out, within};

/// Chance below which a coefficient differs within and between sessions.
const DISAGREES: f64 = 0.005;

/// One effect at its best shape.
#[derive(Clone)]
pub struct Candidate {
    /// The effect.
    pub effect: EffectHandle,
    /// Its best shape.
    pub shape: Vec<f64>,
    /// What it explains.
    pub score: Score,
    /// Mean square left out, everything shared, with it \[Nm²\].
    pub left_out: f64,
    /// Whether sign and size of its coefficients make sense.
    pub plausible: bool,
    /// Shapes of it that were tried.
    pub variants: usize,
}

impl Candidate {
    /// Its id.
    #[must_use]
    pub fn id(&self) -> &str {
        &self.effect.description().id
    }
}

/// Candidates, best first, and how many variants were tried.
pub struct Trial {
    /// One for each effect.
    pub candidates: Vec<Candidate>,
    /// Shapes tried in all, for the correction of p-values.
    pub variants: usize,
    /// Of these, such as show between sessions.
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

/// Effects that the model may lack: those that it has not, and that are not a
/// part of one it has.
#[must_use]
pub fn missing(setup: &Setup) -> Vec<EffectHandle> {
    let has_whole = |part: &Row| {
        let mut own = setup.terms.iter().map(|t| t.effect.row());
        own.any(|whole| whole.has(part))
    };
    let has_part = |whole: &Row| whole.is_sum && whole.parts().any(|p| setup.has(p));
    effects::of(setup.facts.joint.subject())
        .into_iter()
        .filter(|effect| {
            let row = effect.row();
            let there = setup.has(row.id) || has_whole(row) || has_part(row);
            !there && effect.unavailable(&setup.facts).is_none()
        })
        .collect()
}

/// Scores one effect at one shape.
#[must_use]
pub fn score(
    setup: &Setup,
    design: &Design,
    effect: &EffectHandle,
    shape: &[f64],
) -> (Score, BlockGrams) {
    let grams = design.with(&design.extra_columns(setup, effect, shape));
    let score = if effect.row().is_between_sessions() && setup.facts.sessions >= 3 {
        let mut score = between(design, &grams);
        // What a session does to a coefficient is one number a session: a line
        // through these is the honest test.
        let varied = effect.row().varies;
        if let Some(p) = varied.and_then(|id| trend(setup, design, &grams, id)) {
            score.p_value = p;
        }
        // What changes within a session has to change it there as much.
        if agreement(design, &grams) < DISAGREES {
            score.p_value = 1.0;
        }
        score
    } else {
        within(design, &grams)
    };
    (score, grams)
}

/// Tries everything.
#[must_use]
pub fn try_all(setup: &Setup, design: &Design, progress: &mut dyn FnMut(f64)) -> Trial {
    let effects = missing(setup);
    let mut trial = Trial {
        candidates: Vec::new(),
        variants: 0,
        variants_between: 0,
    };
    let count = effects.len().max(1) as f64;
    for (done, effect) in effects.iter().enumerate() {
        let mut shapes = refine::grid(setup, effect);
        let mut searched = 0;
        if effect.row().is_periodic {
            shapes.extend(
                periodic::peaks(setup, design, effect, 3)
                    .into_iter()
                    .map(|k| vec![k]),
            );
            searched = periodic::tried(setup, effect);
        }
        let variants = shapes.len() + searched;
        match effect.row().is_between_sessions() {
            true => trial.variants_between += variants,
            false => trial.variants += variants,
        }
        let best = shapes
            .into_iter()
            .map(|shape| (refine::error_of(setup, design, effect, &shape), shape))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        progress((done as f64 + 0.6) / count);
        let Some((error, shape)) = best else { continue };
        // A shape is polished only where the grid found something.
        let shape = if error.is_finite() {
            refine::polish(setup, design, effect, &shape)
        } else {
            shape
        };
        let (score, grams) = score(setup, design, effect, &shape);
        let plausible = effect.plausible(&shape, &score.coefficients);
        trial.candidates.push(Candidate {
            effect: effect.clone(),
            left_out: left_out(design, &grams),
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
