//! The effects of a model as they stand in it.

use std::ops::Range;

use super::EffectHandle;

/// An effect of a model with its shape.
#[derive(Clone)]
pub struct BoundTerm {
    /// The effect.
    pub effect: EffectHandle,
    /// Values of its shape parameters, in the order of its description and in the
    /// units stated there.
    pub shape: Vec<f64>,
    /// Coefficients with which the channels have been compensated for it, in the
    /// order of its columns; empty for an effect that acts on torque, and before
    /// the first compensation.
    pub compensated: Vec<f64>,
}

impl BoundTerm {
    /// An `effect` with one value of `shape` for each of its shape parameters, for
    /// which the channels are not compensated.
    #[must_use]
    pub fn new(effect: EffectHandle, shape: Vec<f64>) -> Self {
        Self {
            effect,
            shape,
            compensated: Vec::new(),
        }
    }
}

/// The terms of a model, each with the range of its columns among those of all terms.
pub fn with_columns(terms: &[BoundTerm]) -> impl Iterator<Item = (&BoundTerm, Range<usize>)> {
    terms.iter().scan(0, |first, term| {
        let columns = *first..*first + term.effect.columns();
        *first = columns.end;
        Some((term, columns))
    })
}
