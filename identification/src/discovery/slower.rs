//! Formulas over signals that have noise of the acceleration, looked at with a slower filter as well.
//!
//! J q̈ has noise that is in the residual where the position is coarse, and terms over q̈ can tell
//! some of it, alone or beside the right law. What they explain falls with the noise then, where what
//! a law explains stays (`diagnosis::confirmation`).

use super::fitted::Fitted;
use crate::data::{ModelSpec, Term};
use crate::design::{Design, PreparedModel};
use crate::diagnosis::confirmation::FACTOR;
use crate::fit::{Fit, fit};
use crate::preparation::Filtered;
use crate::validation::left_out::Decrease;

/// Smallest ratio of the mean squares that the terms of a law explain there and here: half the
/// amplitude. Noise keeps 1/32.
const MIN_RATIO: f64 = 0.25;

/// The recordings at half the cut-off, with the model fitted to them.
pub(super) struct Slower<'a> {
    spec: &'a ModelSpec,
    /// `None` where they are too short for it, which tells nothing against a formula.
    fitted: Option<(Filtered<'a>, PreparedModel, Fit)>,
}

impl<'a> Slower<'a> {
    /// Of the recordings in `filtered` and the model `spec`.
    pub(super) fn new(filtered: &Filtered<'a>, spec: &'a ModelSpec) -> Self {
        let filtered = filtered.at_factor(FACTOR);
        let prepared = filtered.bind(spec).ok();
        Self {
            spec,
            fitted: prepared.map(|own| {
                let base = fit(&own, &Design::new(&own));
                (filtered, own, base)
            }),
        }
    }

    /// Whether the terms that `formula` has beyond its `rest` explain as much as `here`, about.
    pub(super) fn confirms(&self, formula: &Term, rest: Option<&Term>, here: Decrease) -> bool {
        let Some((filtered, prepared, base)) = &self.fitted else {
            return true;
        };
        let fitted = Fitted {
            filtered,
            spec: self.spec,
            prepared,
            base,
        };
        let (Some(before), Some(after)) = (fitted.left_out(rest), fitted.left_out(Some(formula)))
        else {
            return false;
        };
        let there = after.decrease_from(&before);
        there.is_certain() && there.mean_square > MIN_RATIO * here.mean_square
    }
}
