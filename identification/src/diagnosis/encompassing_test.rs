//! Encompassing tests of effects that explain as much as each other (Mizon, The
//! encompassing approach in econometrics, 1984; Davidson and MacKinnon's J test of
//! models that are not nested): one encompasses the other if, with the one in the
//! model, the other explains nothing more, while the converse does not hold.

use super::candidates::Candidate;
use super::equivalents::as_good;
use crate::design::{Design, PreparedModel};
use crate::effects::{Effect, EffectDescription, EffectHandle, MAX_COLUMNS, Memory, Point};
use crate::validation::beside;

/// An effect adds to a rival if the p-value of its coefficients beside it is below this …
pub(super) const MAX_P_VALUE_ADDING: f64 = 1e-4;
/// … and adds nothing if it is above this.
pub(super) const MIN_P_VALUE_REDUNDANT: f64 = 0.01;

/// One column of an effect, as an effect of its own.
pub(super) struct SingleColumn {
    pub(super) whole: EffectHandle,
    pub(super) column: usize,
}

impl Effect for SingleColumn {
    fn description(&self) -> &EffectDescription {
        self.whole.description()
    }

    fn columns(&self) -> usize {
        1
    }

    fn evaluate(&self, shape: &[f64], point: &Point, memory: &mut Memory, columns: &mut [f64]) {
        let mut all = [0.0; MAX_COLUMNS];
        let count = self.whole.columns().min(MAX_COLUMNS);
        self.whole.evaluate(shape, point, memory, &mut all[..count]);
        columns.fill(all[self.column]);
    }
}

/// Columns of an effect: by session, column and row.
pub(super) type BySession = Vec<Vec<Vec<f64>>>;

/// p-value of the coefficients of `effect` in a model that has `first`, too.
pub(super) fn p_value_beside(
    prepared: &PreparedModel,
    design: &Design,
    first: &Candidate,
    effect: &EffectHandle,
    shape: &[f64],
) -> f64 {
    let columns = design.extra_columns(prepared, &first.effect, &first.shape);
    let more = design.extra_columns(prepared, effect, shape);
    p_value_of_columns(design, columns, more)
}

/// p-value of the coefficients of the columns `more` in a model that has `columns`, too.
pub(super) fn p_value_of_columns(design: &Design, mut columns: BySession, more: BySession) -> f64 {
    let first = columns.first().map_or(0, Vec::len);
    for (own, more) in columns.iter_mut().zip(more) {
        own.extend(more);
    }
    beside(design, &design.with(&columns), first)
}

/// The column that `whole` has beyond the effect `part`, where it contains that.
fn beyond(whole: &Candidate, part: &Candidate) -> Option<usize> {
    whole.effect.row().column_beyond(part.id())
}

/// Leaves out of `passing` the effects that are one of the others with a redundant
/// term: a line over position whose slope adds nothing to its constant.
pub fn drop_redundant_terms(
    prepared: &PreparedModel,
    design: &Design,
    passing: &mut Vec<Candidate>,
) {
    let all = passing.clone();
    passing.retain(|whole| {
        !all.iter().any(|part| {
            beyond(whole, part).is_some_and(|column| {
                let beyond: EffectHandle = std::sync::Arc::new(SingleColumn {
                    whole: whole.effect.clone(),
                    column,
                });
                p_value_beside(prepared, design, part, &beyond, &whole.shape)
                    > MIN_P_VALUE_REDUNDANT
            })
        })
    });
}

/// Leaves out of `passing` the rivals that are as good as the first but are
/// encompassed by it: beside such a rival the first still explains something, while
/// beside the first the rival explains nothing. A rival that encompasses the first
/// takes its place. For effects that show within sessions.
pub fn drop_encompassed(prepared: &PreparedModel, design: &Design, passing: &mut Vec<Candidate>) {
    let Some(first) = passing.first().cloned() else {
        return;
    };
    if first.effect.row().is_between_sessions() {
        return;
    }
    let rivals: Vec<Candidate> = passing
        .iter()
        .skip(1)
        .filter(|other| !other.effect.row().is_between_sessions() && as_good(design, &first, other))
        .filter(|other| beyond(&first, other).is_none() && beyond(other, &first).is_none())
        .cloned()
        .collect();
    let p_value = |beside: &Candidate, own: &Candidate| {
        p_value_beside(prepared, design, beside, &own.effect, &own.shape)
    };
    let mut better = None;
    for rival in rivals {
        let (of_first, of_rival) = (p_value(&rival, &first), p_value(&first, &rival));
        let encompasses =
            |one: f64, other: f64| one < MAX_P_VALUE_ADDING && other > MIN_P_VALUE_REDUNDANT;
        if encompasses(of_first, of_rival) {
            passing.retain(|c| c.id() != rival.id());
        } else if encompasses(of_rival, of_first) && better.is_none() {
            better = Some(rival.id().to_owned());
        }
    }
    if let Some(at) = better.and_then(|id| passing.iter().position(|c| c.id() == id)) {
        let better = passing.remove(at);
        if let Some(first) = passing.first_mut() {
            *first = better;
        }
    }
}
