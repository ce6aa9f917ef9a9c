//! Backlash or presliding: both act just after a reversal, where the rows of
//! the regression are left out, so that they are distinguished on all rows.
//!
//! The fit on sliding rows fixes the size of each. Bristles carry the model's own
//! Coulomb friction, b_0 + b_0T |τ| (z instead of sign(q̇)); a gap takes away all
//! that the gear transmits, τ + τ_F. So both have one coefficient, which should
//! be 1, and one shape. With free coefficients bristles would imitate a gap by
//! friction that falls with the load.

use std::sync::Arc;

use super::candidates::{Candidate, score};
use super::equivalents;
use crate::design::{Design, PreparedModel};
use crate::effects::{
    self, AtReversal, BoundTerm, Effect, EffectDescription, EffectHandle, Facts, Memory, Part,
    Point,
};
use crate::shape_search;

/// Presliding whose bristles carry the Coulomb friction found on sliding rows.
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

/// If the first of `passing` is one of the two, both are scored again on all
/// rows. The one that explains more of them comes first; the other stays, at
/// second place, only where the data cannot distinguish them.
pub fn decide(prepared: &PreparedModel, passing: &mut Vec<Candidate>, tried: &[Candidate]) {
    let is_either = |c: &Candidate| c.effect.row().at_reversal.is_some();
    let in_model = |term: &BoundTerm| term.effect.row().at_reversal.is_some();
    if !passing.first().is_some_and(is_either) || prepared.terms.iter().any(in_model) {
        return;
    }
    let [Some(bristles), Some(gap)] = [AtReversal::Bristles, AtReversal::Gap]
        .map(|own| effects::find_by_row(|row| row.at_reversal == Some(own)))
    else {
        return;
    };
    let sliding = Design::new(prepared);
    let level = sliding.coefficient(prepared, Part::Constant);
    let by_load = sliding.coefficient(prepared, Part::ByLoad);
    if level <= 0.0 || gap.unavailable(&prepared.facts).is_some() {
        return;
    }
    let bristles: EffectHandle = Arc::new(Bristles {
        free: bristles,
        level,
        by_load,
    });
    let whole = prepared.with_reversals();
    let design = Design::new(&whole);
    let [Some(bristles), Some(gap)] =
        [bristles, gap].map(|effect| on_all_rows(&whole, &design, effect))
    else {
        return;
    };
    let (best, other) = match bristles.score.gain > gap.score.gain {
        true => (bristles, gap),
        false => (gap, bristles),
    };
    let undecided = equivalents::as_good(&design, &best, &other);
    // Gains are reported on the same rows as those of all others, p-values on all
    // rows, which prove them.
    let reported = |proven: &Candidate| {
        let mut own = tried.iter().find(|c| c.id() == proven.id()).cloned()?;
        own.score.p_value = proven.score.p_value;
        Some(own)
    };
    let (Some(best), Some(other)) = (reported(&best), reported(&other)) else {
        return;
    };
    passing.retain(|c| !is_either(c));
    if undecided {
        passing.insert(0, other);
    }
    passing.insert(0, best);
}

/// The effect at its best shape on all rows.
fn on_all_rows(whole: &PreparedModel, design: &Design, effect: EffectHandle) -> Option<Candidate> {
    let shape = shape_search::search(whole, design, &effect)?;
    let score = score(whole, design, &effect, &shape);
    let plausible = effect.plausible(&shape, &score.coefficients);
    Some(Candidate {
        effect,
        shape,
        score,
        plausible,
        variants: 1,
    })
}
