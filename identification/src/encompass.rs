//! Which of two effects that explain as much is enough: beside it the other
//! explains nothing more, while beside the other it still does (Davidson and
//! MacKinnon's encompassing test of models that are not nested).

use crate::candidates::Candidate;
use crate::design::Design;
use crate::effects::{Effect, EffectDescription, EffectHandle, MAX_COLUMNS, Memory, Point};
use crate::family::as_good;
use crate::setup::Setup;
use crate::validation::beside;

/// What adds to a rival does so with this chance by scatter at most …
const ADDS: f64 = 1e-4;
/// … and what adds nothing with this at least.
const ADDS_NOTHING: f64 = 0.01;

/// One column of an effect.
struct Beyond {
    whole: EffectHandle,
    column: usize,
}

impl Effect for Beyond {
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

/// Chance that scatter alone makes `effect` explain as much beside `first` as it does.
fn adds(
    setup: &Setup,
    design: &Design,
    first: &Candidate,
    effect: &EffectHandle,
    shape: &[f64],
) -> f64 {
    let mut columns = design.extra_columns(setup, &first.effect, &first.shape);
    let more = design.extra_columns(setup, effect, shape);
    for (own, more) in columns.iter_mut().zip(more) {
        own.extend(more);
    }
    beside(design, &design.with(&columns), first.effect.columns())
}

fn beyond(whole: &Candidate, part: &Candidate) -> Option<usize> {
    whole.effect.row().column_beyond(part.id())
}

/// Leaves out of `passing` what is one of the others with a term too many: a
/// line over position whose slope adds nothing to its constant.
pub fn without_idle_terms(setup: &Setup, design: &Design, passing: &mut Vec<Candidate>) {
    let all = passing.clone();
    passing.retain(|whole| {
        !all.iter().any(|part| {
            beyond(whole, part).is_some_and(|column| {
                let beyond: EffectHandle = std::sync::Arc::new(Beyond {
                    whole: whole.effect.clone(),
                    column,
                });
                adds(setup, design, part, &beyond, &whole.shape) > ADDS_NOTHING
            })
        })
    });
}

/// Leaves those out of `passing` that are as good as the first on the whole, but
/// are not enough: beside such a rival the first still explains something, while
/// beside the first the rival explains nothing. The other way round the rival
/// takes the first place. For effects that show within sessions.
pub fn settle(setup: &Setup, design: &Design, passing: &mut Vec<Candidate>) {
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
    let adds =
        |to: &Candidate, other: &Candidate| adds(setup, design, to, &other.effect, &other.shape);
    let mut better = None;
    for rival in rivals {
        let (first_adds, rival_adds) = (adds(&rival, &first), adds(&first, &rival));
        if first_adds < ADDS && rival_adds > ADDS_NOTHING {
            passing.retain(|c| c.id() != rival.id());
        } else if rival_adds < ADDS && first_adds > ADDS_NOTHING && better.is_none() {
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
