//! A part of a session: what is around some of its rows.

use std::ops::Range;
use std::sync::Arc;

use super::{Channels, Signals};

/// Runs of samples that are kept, in order of time, put one after the other.
struct Runs {
    /// Each with the place of its first sample among those kept.
    runs: Vec<(Range<usize>, usize)>,
}

impl Runs {
    /// Samples up to `margin` away from one of `rows`, of `length`.
    fn around(rows: &[usize], margin: usize, length: usize) -> Self {
        let mut runs: Vec<Range<usize>> = Vec::new();
        for row in rows {
            let (from, to) = (row.saturating_sub(margin), (row + margin + 1).min(length));
            match runs.last_mut() {
                Some(last) if from <= last.end => last.end = to,
                _ => runs.push(from..to),
            }
        }
        let mut place = 0;
        let runs = runs.into_iter().map(|run| {
            let first = place;
            place += run.len();
            (run, first)
        });
        Self {
            runs: runs.collect(),
        }
    }

    /// The samples of `signal` that are kept.
    fn of<T: Copy>(&self, signal: &[T]) -> Vec<T> {
        let each = self
            .runs
            .iter()
            .filter_map(|(run, _)| signal.get(run.clone()));
        each.flatten().copied().collect()
    }

    /// Where the sample `at` is among those kept.
    fn place(&self, at: usize) -> Option<usize> {
        let after = self.runs.partition_point(|(run, _)| run.end <= at);
        let (run, first) = self.runs.get(after)?;
        run.contains(&at).then(|| first + at - run.start)
    }
}

impl Signals {
    /// The session as if nothing had been recorded but what is within `margin` samples of
    /// `rows`, which become its rows: these runs follow each other, so that an effect with a
    /// memory goes on from the end of one to the start of the next.
    #[must_use]
    pub(crate) fn part(&self, rows: &[usize], margin: usize) -> Self {
        let runs = Runs::around(rows, margin, self.points.len());
        let places = |rows: &[usize]| rows.iter().filter_map(|at| runs.place(*at)).collect();
        let raw = Arc::new(Channels {
            position: runs.of(&self.raw.position),
            motor_torque: runs.of(&self.raw.motor_torque),
            joint_torque: runs.of(&self.raw.joint_torque),
        });
        let named = self.extra.iter();
        let columns = self.jacobians.iter();
        Self {
            name: self.name.clone(),
            period: self.period,
            column: self.column.clone(),
            kept: Arc::default(),
            points: Arc::new(runs.of(&self.points)),
            extra: named
                .map(|(name, own)| (name.clone(), runs.of(own)))
                .collect(),
            raw: raw.clone(),
            recorded: raw,
            jacobians: columns
                .map(|(id, own)| {
                    (
                        id.clone(),
                        own.iter().map(|column| runs.of(column)).collect(),
                    )
                })
                .collect(),
            rows: places(rows),
            unjudged_rows: Vec::new(),
            unloaded: self.unloaded,
            rows_with_reversals: Vec::new(),
            all_rows: Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_around_rows_is_kept_once() {
        let runs = Runs::around(&[3, 5, 20, 38], 2, 40);
        let signal: Vec<usize> = (0..40).collect();
        let kept = runs.of(&signal);
        assert_eq!(
            kept,
            [1, 2, 3, 4, 5, 6, 7, 18, 19, 20, 21, 22, 36, 37, 38, 39]
        );
        for (place, at) in kept.iter().enumerate() {
            assert_eq!(runs.place(*at), Some(place));
        }
        assert_eq!(runs.place(8), None);
        assert_eq!(runs.place(0), None);
    }
}
