//! Backlash or presliding: both act just after a reversal, where the rows of
//! the regression are left out, so that this is where they are held apart.
//!
//! Each is held to what sliding says of it. Bristles carry the model's own
//! Coulomb friction, b_0 + b_0T |τ| (z instead of sign(q̇)); a gap takes away all
//! that the gear transmits, τ + τ_F. So both have one coefficient, which should
//! be 1, and one shape. Left free, bristles would imitate a gap by friction
//! that falls with load.

use std::sync::Arc;

use crate::candidates::{Candidate, score};
use crate::design::Design;
use crate::effects::{
    self, AtReversal, Effect, EffectDescription, EffectHandle, Facts, Memory, Part, Point,
};
use crate::family;
use crate::refine;
use crate::setup::{BoundTerm, Setup};
use crate::validation::left_out;

/// Bristles that carry the Coulomb friction found in sliding.
struct Bristles {
    free: EffectHandle,
    /// b_0 \[Nm\].
    level: f64,
    /// b_0T \[-\].
    by_load: f64,
}

impl Effect for Bristles {
    fn description(&self) -> &EffectDescription {
        self.free.description()
    }

    fn columns(&self) -> usize {
        1
    }

    fn evaluate(&self, shape: &[f64], point: &Point, memory: &mut Memory, columns: &mut [f64]) {
        let mut own = [0.0; 2];
        self.free.evaluate(shape, point, memory, &mut own);
        if let [column] = columns {
            *column = self.level * own[0] + self.by_load * own[1];
        }
    }

    fn shapes(&self, facts: &Facts) -> Vec<Vec<f64>> {
        self.free.shapes(facts)
    }

    fn bounds(&self, facts: &Facts) -> Vec<[f64; 2]> {
        self.free.bounds(facts)
    }

    fn plausible(&self, _shape: &[f64], coefficients: &[f64]) -> bool {
        coefficients.iter().all(|c| (0.3..1.7).contains(c))
    }
}

/// If the first of `passing` is one of the two, both are tried again on all
/// rows. The one that explains more of them comes first; the other stays only
/// where these data cannot tell, and then at second place.
pub fn settle(setup: &Setup, passing: &mut Vec<Candidate>, tried: &[Candidate]) {
    let is_either = |c: &Candidate| c.effect.row().at_reversal.is_some();
    let in_model = |term: &BoundTerm| term.effect.row().at_reversal.is_some();
    if !passing.first().is_some_and(is_either) || setup.terms.iter().any(in_model) {
        return;
    }
    let [Some(bristles), Some(gap)] = [AtReversal::Bristles, AtReversal::Gap]
        .map(|own| effects::with(|row| row.at_reversal == Some(own)))
    else {
        return;
    };
    let level = setup.coefficient(Part::Constant);
    let by_load = setup.coefficient(Part::ByLoad);
    if level <= 0.0 || gap.unavailable(&setup.facts).is_some() {
        return;
    }
    let bristles: EffectHandle = Arc::new(Bristles {
        free: bristles,
        level,
        by_load,
    });
    let whole = setup.with_reversals();
    let design = Design::new(&whole);
    let [Some(bristles), Some(gap)] = [bristles, gap].map(|effect| held(&whole, &design, effect))
    else {
        return;
    };
    let (best, other) = match bristles.score.gain > gap.score.gain {
        true => (bristles, gap),
        false => (gap, bristles),
    };
    let undecided = family::as_good(&design, &best, &other);
    // What is said of them is reported on the same rows as of all others, but that
    // they are there is proven by all rows.
    let told = |held: &Candidate| {
        let mut own = tried.iter().find(|c| c.id() == held.id()).cloned()?;
        own.score.p_value = held.score.p_value;
        Some(own)
    };
    let (Some(best), Some(other)) = (told(&best), told(&other)) else {
        return;
    };
    passing.retain(|c| !is_either(c));
    if undecided {
        passing.insert(0, other);
    }
    passing.insert(0, best);
}

/// The effect at its best shape on all rows.
fn held(whole: &Setup, design: &Design, effect: EffectHandle) -> Option<Candidate> {
    let shape = refine::search(whole, design, &effect)?;
    let (score, grams) = score(whole, design, &effect, &shape);
    let plausible = effect.plausible(&shape, &score.coefficients);
    Some(Candidate {
        left_out: left_out(design, &grams),
        effect,
        shape,
        score,
        plausible,
        variants: 1,
    })
}
