//! Signals that are recorded more often than they are measured.

use std::ops::Range;

use ferntast_identification::numerics::statistics::quantile;

use super::{runs_of_equal, steps::Steps};

/// Share of the values that stand for as many samples as most do.
const MIN_SHARE: f64 = 0.9;
/// Most steps are so many times as large as the smallest: else it is the sensor's resolution
/// that values stand for several samples by.
const TIMES_LEAST: f64 = 3.0;

/// A signal that is held between its measurements.
#[derive(Debug, PartialEq)]
pub(super) struct Held {
    /// Samples that each value stands for.
    pub(super) every: usize,
    /// Samples that repeat the value of the one before.
    pub(super) repeats: Vec<Range<usize>>,
}

/// Finds that each value stands for as many samples, give or take one; `None` where values
/// are as they were measured. Held, they are late by half of that on the average.
pub(super) fn repeats(values: &[f64]) -> Option<Held> {
    let runs: Vec<Range<usize>> = runs_of_equal(values).collect();
    let mut lengths: Vec<usize> = runs.iter().map(Range::len).collect();
    let every = quantile(&mut lengths, 0.5, usize::cmp)?;
    let slack = usize::from(every > 2);
    let usual = lengths.iter().filter(|own| own.abs_diff(every) <= slack);
    if every < 2 || (usual.count() as f64) < MIN_SHARE * lengths.len() as f64 {
        return None;
    }
    let steps = Steps::of(values);
    if steps.middle == 0.0 || steps.middle < TIMES_LEAST * steps.least {
        return None;
    }
    let repeats = runs.into_iter().map(|run| run.start + 1..run.end);
    Some(Held {
        every,
        repeats: repeats.filter(|run| !run.is_empty()).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_held_is_told_from_what_is_coarse() {
        let smooth = |at: usize| (at as f64 * 0.01).sin();
        let held: Vec<f64> = (0..1000).map(|at| smooth(at / 4 * 4)).collect();
        let found = repeats(&held).unwrap();
        assert_eq!((found.every, found.repeats[0].clone()), (4, 1..4));
        assert_eq!(found.repeats.iter().map(Range::len).sum::<usize>(), 750);
        let plain: Vec<f64> = (0..1000).map(smooth).collect();
        assert_eq!(repeats(&plain), None);
        // A constant speed, read by an encoder of which a count is four samples.
        let coarse: Vec<f64> = (0..1000).map(|at| (at / 4) as f64).collect();
        assert_eq!(repeats(&coarse), None);
        // 60 Hz in rows of 200.
        let uneven: Vec<f64> = (0..1000).map(|at| smooth((at * 3 / 10) * 10)).collect();
        assert_eq!(repeats(&uneven).map(|held| held.every), Some(3));
        assert!(repeats(&[]).is_none() && repeats(&[1.0; 9]).is_none());
    }
}
