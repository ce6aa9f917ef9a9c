//! A part of very many rows: of every block of time an even share, in runs.
//!
//! An effect that explains a hundredth of the mean square stands far out of the noise of ten
//! thousand rows; more of them tell its size and shape more exactly, not whether it is there.

use super::Rows;
use crate::design::{Design, PreparedModel};

/// Rows from which on a part of them is searched first.
const MIN_ROWS: usize = 50_000;
/// Rows of the part, about.
const ROWS_OF_PART: usize = 12_500;
/// Rows of a run, about; …
const ROWS_OF_RUN: usize = 256;
/// … and at least, unless there are fewer.
const MIN_ROWS_OF_RUN: usize = 64;
/// Time \[s\] before and after a run that effects with a memory, and those that look back or
/// ahead, are given.
const MARGIN: f64 = 0.25;

/// A model on a part of its rows.
pub(super) struct Part {
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
        let each = design.sessions.iter();
        let numbers: Vec<Vec<usize>> = each
            .map(|session| {
                let blocks = session.blocks.iter();
                blocks.flat_map(|block| runs(*block, share)).collect()
            })
            .collect();
        let each = prepared.sessions.iter().zip(&numbers);
        let sessions = each.map(|(signals, numbers)| {
            let rows: Vec<usize> = numbers.iter().map(|row| signals.rows[*row]).collect();
            let of_filter = signals.column.taps().len() / 2;
            signals.part(&rows, of_filter + (MARGIN / signals.period).ceil() as usize)
        });
        Self {
            prepared: PreparedModel {
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

    pub(super) fn rows(&self) -> Rows<'_> {
        Rows {
            prepared: &self.prepared,
            design: &self.design,
        }
    }
}

/// Numbers of the rows of a block of which one in `share` is kept: runs of equal length, each
/// in the middle of its share of the block.
fn runs((from, to): (usize, usize), share: usize) -> impl Iterator<Item = usize> {
    let count = to - from;
    let runs = (count / (share * ROWS_OF_RUN)).max(1);
    let length = (count / (runs * share))
        .max(MIN_ROWS_OF_RUN)
        .min(count / runs);
    (0..runs).flat_map(move |run| {
        let (first, end) = (run * count / runs, (run + 1) * count / runs);
        let start = from + first + (end - first - length) / 2;
        start..start + length
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_of_a_block_has_its_share() {
        let kept: Vec<usize> = runs((1000, 11_000), 5).collect();
        assert!((1900..=2000).contains(&kept.len()), "{}", kept.len());
        assert!(kept.windows(2).all(|both| both[0] < both[1]));
        for fifth in 0..5 {
            let (from, to) = (1000 + 2000 * fifth, 3000 + 2000 * fifth);
            let here = kept.iter().filter(|row| (from..to).contains(*row)).count();
            // Seven runs of 285.
            assert!((285..=570).contains(&here), "{here} of {from} to {to}");
        }
    }

    #[test]
    fn a_short_block_is_kept() {
        assert!(runs((30, 70), 5).eq(30..70));
        assert_eq!(runs((0, 200), 5).count(), MIN_ROWS_OF_RUN);
        assert_eq!(runs((5, 5), 5).count(), 0);
    }
}
