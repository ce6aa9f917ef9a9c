//! A model fitted to recordings with one filter, to which formulas are added.

use crate::data::{ModelSpec, Term};
use crate::design::{Design, PreparedModel};
use crate::fit::Fit;
use crate::fit::addition::{Addition, add_to};
use crate::preparation::Filtered;
use crate::validation::left_out::LeftOut;

/// The model, the recordings, and what came of it.
#[derive(Clone, Copy)]
pub(super) struct Fitted<'a> {
    pub(super) filtered: &'a Filtered<'a>,
    pub(super) spec: &'a ModelSpec,
    /// The model bound to the recordings.
    pub(super) prepared: &'a PreparedModel,
    pub(super) base: &'a Fit,
}

impl Fitted<'_> {
    /// The model with one more effect, and what it leaves of rows left out.
    pub(super) fn with(&self, effect: &Term) -> Option<(Addition, LeftOut)> {
        let both = (self.prepared, self.base);
        let (addition, extended) = add_to(self.filtered, self.spec, both, effect, None).ok()?;
        let left_out = LeftOut::new(&extended, &Design::new(&extended));
        Some((addition, left_out))
    }

    /// What the model leaves of rows left out, with an effect or without.
    pub(super) fn left_out(&self, effect: Option<&Term>) -> Option<LeftOut> {
        match effect {
            Some(effect) => self.with(effect).map(|(_, left_out)| left_out),
            None => Some(self.base.left_out.clone()),
        }
    }
}
