//! A part of very many rows: of every block of time an even share, in runs.
//!
//! An effect that explains a hundredth of the mean square stands far out of the noise of ten
//! thousand rows; more of them tell its size and shape more exactly, not whether it is there.

use super::Rows;
use crate::design::{Design, PreparedModel};
use crate::effects::EffectHandle;

/// Rows from which on a part of them is searched first.
const MIN_ROWS: usize = 50_000;
/// Rows of the part, about.
const ROWS_OF_PART: usize = 12_500;
/// Runs for functions of the state alone: short, so that a slow motion has all its places in them.
const OF_STATES: Runs = Runs {
    rows: 64,
    margin: 0.0,
};
/// Runs for effects with a memory, and those that look back or ahead.
const OF_MOTIONS: Runs = Runs {
    rows: 256,
    margin: 0.25,
};
/// Share of its rows that a run has at least, unless there are fewer.
const LEAST_OF_RUN: usize = 4;

/// How the rows of the part are chosen.
#[derive(Clone, Copy)]
struct Runs {
    /// Rows of a run, about.
    rows: usize,
    /// Time \[s\] before and after a run that columns are made of, besides what the filter looks
    /// at.
    margin: f64,
}

/// A model on parts of its rows.
pub(super) struct Part {
    of_states: Kept,
    of_motions: Kept,
}

/// A model on some of its rows.
struct Kept {
    prepared: PreparedModel,
    design: Design,
}

impl Part {
    /// `None` where there are not that many rows.
    pub(super) fn new(prepared: &PreparedModel, design: &Design) -> Option<Self> {
        let sessions = design.sessions.iter();
        let rows: usize = sessions.map(|session| session.measured.len()).sum();
        (rows >= MIN_ROWS).then(|| Self::one_in(rows / ROWS_OF_PART, prepared, design))
    }

    /// One row in so many.
    pub(super) fn one_in(share: usize, prepared: &PreparedModel, design: &Design) -> Self {
        Self {
            of_states: Kept::new(OF_STATES, share, prepared, design),
            of_motions: Kept::new(OF_MOTIONS, share, prepared, design),
        }
    }

    /// The rows on which `effect` is searched.
    pub(super) fn rows_for(&self, effect: &EffectHandle, shape: &[f64]) -> Rows<'_> {
        let Kept { prepared, design } = match effect.of_states(shape, &[]) {
            Some(_) => &self.of_states,
            None => &self.of_motions,
        };
        Rows { prepared, design }
    }
}

impl Kept {
    fn new(own: Runs, share: usize, prepared: &PreparedModel, design: &Design) -> Self {
        let each = design.sessions.iter();
        let numbers: Vec<Vec<usize>> = each
            .map(|session| {
                let blocks = session.blocks.iter();
                blocks
                    .flat_map(|block| own.of_block(*block, share))
                    .collect()
            })
            .collect();
        let each = prepared.sessions.iter().zip(&numbers);
        let sessions = each.map(|(signals, numbers)| {
            let rows: Vec<usize> = numbers.iter().map(|row| signals.rows[*row]).collect();
            let of_filter = signals.column.taps().len() / 2;
            let margin = (own.margin / signals.period).ceil() as usize;
            signals.part(&rows, of_filter + margin)
        });
        Self {
            prepared: PreparedModel {
                temperature_is_resolved: prepared.temperature_is_resolved,
                facts: prepared.facts.clone(),
                filters: prepared.filters,
                sessions: sessions.collect(),
                held_out: Vec::new(),
                terms: prepared.terms.clone(),
                reversals: prepared.reversals,
                predicted: prepared.predicted.clone(),
            },
            design: design.on_rows(&numbers),
        }
    }
}

impl Runs {
    /// Numbers of the rows of a block of which one in `share` is kept: runs of equal length, each
    /// in the middle of its share of the block.
    fn of_block(self, (from, to): (usize, usize), share: usize) -> impl Iterator<Item = usize> {
        let count = to - from;
        let runs = (count / (share * self.rows)).max(1);
        let least = self.rows / LEAST_OF_RUN;
        let length = (count / (runs * share)).max(least).min(count / runs);
        (0..runs).flat_map(move |run| {
            let (first, end) = (run * count / runs, (run + 1) * count / runs);
            let start = from + first + (end - first - length) / 2;
            start..start + length
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_of_a_block_has_its_share() {
        let kept: Vec<usize> = OF_STATES.of_block((1000, 11_000), 5).collect();
        assert!((1900..=2000).contains(&kept.len()), "{}", kept.len());
        assert!(kept.windows(2).all(|both| both[0] < both[1]));
        for fifth in 0..5 {
            let (from, to) = (1000 + 2000 * fifth, 3000 + 2000 * fifth);
            let here = kept.iter().filter(|row| (from..to).contains(*row)).count();
            // 31 runs of 64.
            assert!((384..=448).contains(&here), "{here} of {from} to {to}");
        }
    }

    #[test]
    fn a_short_block_is_kept() {
        assert!(OF_STATES.of_block((30, 46), 5).eq(30..46));
        assert_eq!(OF_STATES.of_block((0, 70), 5).count(), 16);
        assert_eq!(OF_STATES.of_block((5, 5), 5).count(), 0);
    }
}
