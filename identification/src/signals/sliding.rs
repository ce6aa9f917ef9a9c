//! Where a joint slides and a tip touches: only there friction has a value of its own.

use super::{Filters, Point};

/// Longest time \[s\] near rest that is a reversal of a tip; after a longer one
/// the tip is at rest.
const MAX_REVERSAL_DURATION: f64 = 0.15;

/// Which samples slide: faster than rest, and some way past the last reversal.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sliding {
    direction: f64,
    travelled: f64,
}

/// How a joint moves at one sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Motion {
    /// Friction has a value of its own.
    Slides,
    /// Near rest.
    Slow,
    /// Friction still builds up.
    JustReversed,
}

impl Sliding {
    /// Whether the next sample, in order of time, slides.
    pub(crate) fn next(&mut self, point: &Point, filters: &Filters) -> bool {
        self.motion(point, filters) == Motion::Slides
    }

    /// How the joint moves at the next sample, in order of time.
    pub(crate) fn motion(&mut self, point: &Point, filters: &Filters) -> Motion {
        // A fast change of speed passes rest between two samples.
        let passing = 2.0 * point.acceleration.abs() * point.period;
        if point.velocity.abs() < filters.rest_speed.max(passing) {
            return Motion::Slow;
        }
        if point.velocity.signum() != self.direction {
            self.direction = point.velocity.signum();
            self.travelled = 0.0;
        }
        self.travelled += point.velocity.abs() * point.period;
        match self.travelled > filters.travel {
            true => Motion::Slides,
            false => Motion::JustReversed,
        }
    }
}

/// Rows with no bad sample nearer than `reach` samples on either side: the weights of a filter that
/// looks so far are next to nothing there.
pub(super) fn rows_clear_of_bad_samples(rows: &[usize], good: &[bool], reach: usize) -> Vec<usize> {
    let mut bad = vec![0_usize; good.len() + 1];
    for (at, good) in good.iter().enumerate() {
        bad[at + 1] = bad[at] + usize::from(!good);
    }
    let rows = rows.iter().copied();
    rows.filter(|at| bad[at + reach] == bad[at + 1 - reach])
        .collect()
}

/// Which samples of a contact count: the tip touches and is not at rest, where
/// F_T may have any value that friction holds. Reversals count: compliance before
/// the tip slides shows nowhere else.
pub(super) fn touches_and_moves(points: &[Point], rest_speed: f64, least_force: f64) -> Vec<bool> {
    let mut counts: Vec<bool> = points.iter().map(|p| p.load > least_force).collect();
    let is_slow = |at: usize| points[at].velocity.abs() < rest_speed;
    let mut at = 0;
    while at < points.len() {
        let from = at;
        let mut time = 0.0;
        while at < points.len() && is_slow(at) {
            time += points[at].period;
            at += 1;
        }
        if time > MAX_REVERSAL_DURATION {
            counts[from..at].fill(false);
        }
        at += 1;
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bad_sample_counts_as_far_to_either_side_and_no_further() {
        let mut good = vec![true; 40];
        good[20] = false;
        let rows: Vec<usize> = (3..37).collect();
        let clear = rows_clear_of_bad_samples(&rows, &good, 3);
        let expected: Vec<usize> = (3..18).chain(23..37).collect();
        assert_eq!(clear, expected);
    }

    #[test]
    fn a_tip_counts_where_it_touches_and_where_it_turns_but_not_where_it_stays() {
        let velocity = |at: usize| match at {
            0..50 | 130..150 => 0.01,
            50..55 => 0.0,
            55..100 => -0.01,
            _ => 1e-5,
        };
        let points: Vec<Point> = (0..150)
            .map(|at| Point {
                period: 0.01,
                velocity: velocity(at),
                load: if at < 20 { 0.1 } else { 10.0 },
                ..Point::default()
            })
            .collect();
        let counts = touches_and_moves(&points, 1e-3, 1.0);
        for (at, counts) in counts.iter().enumerate() {
            let stays = (100..130).contains(&at);
            assert_eq!(*counts, at >= 20 && !stays, "sample {at}");
        }
    }
}
