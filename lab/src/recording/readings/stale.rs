//! Values that were sent again, since no new one came.

use std::ops::Range;

use ferntast_identification::numerics::statistics::quantile;

use super::{in_each, runs_of_equal, steps::Steps};
use crate::recording::series::Series;

/// Fewest samples with the same value, of a position …
const SHORTEST: usize = 3;
/// … and of a torque, …
const SHORTEST_OF_FORCE: usize = 10;
/// … which is so many times as long as all but one in a hundred of its runs.
const TIMES_RUNS: usize = 5;
/// A position jumps by so many of the smallest steps afterwards, at least, …
const TIMES_LEAST: f64 = 3.0;
/// … and so many steps of motion as fast as it ever is: from rest none is as large.
const TIMES_USUAL: f64 = 2.0;
/// Share of the greatest torque from which on one may be limited.
const LIMITED: f64 = 0.8;
/// Share of its mean speed that a joint moves with, at least, while its torque stands still.
const MIN_SPEED: f64 = 0.2;

/// Finds where a position stands still in motion and then jumps to where the motion has come
/// meanwhile: the repeats, without the sample that is repeated.
pub(super) fn of_position(values: &[f64], stretches: &[Range<usize>]) -> Vec<Range<usize>> {
    let steps = Steps::of(values);
    let least = (TIMES_USUAL * steps.usual).max(TIMES_LEAST * steps.least);
    in_each(values, stretches, |own| {
        let jumps = |run: &Range<usize>| {
            let after = own.get(run.end);
            after.is_some_and(|after| (after - own[run.start]).abs() > least)
        };
        runs_of_equal(own)
            .filter(|run| run.len() >= SHORTEST && jumps(run))
            .map(|run| run.start + 1..run.end)
            .collect()
    })
}

/// Finds where a torque stands still for far longer than it does otherwise while the joint
/// moves. What stands near its greatest or least value, at zero, or several times at one, is
/// limited or switched off.
pub(super) fn of_force(force: &Series, position: Option<&Series>) -> Vec<Range<usize>> {
    let (values, Some(position)) = (&force.values, position) else {
        return Vec::new();
    };
    let mut lengths: Vec<usize> = runs_of_equal(values).map(|run| run.len()).collect();
    let usual = quantile(&mut lengths, 0.99, usize::cmp).unwrap_or(0);
    let shortest = (TIMES_RUNS * usual).max(SHORTEST_OF_FORCE);
    let long: Vec<Range<usize>> = runs_of_equal(values)
        .filter(|run| run.len() >= shortest)
        .collect();
    if long.is_empty() {
        return long;
    }
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let of = |run: &Range<usize>| values[run.start];
    let least_jump = TIMES_USUAL * Steps::of(values).usual;
    let is_level = |run: &Range<usize>| {
        let value = of(run);
        let times = long.iter().filter(|other| of(other) == value).count();
        let is_high = value >= LIMITED * greatest || value <= LIMITED * least;
        // A limit is left as it was come to.
        let after = values.get(run.end);
        let goes_on = after.is_none_or(|after| (after - value).abs() <= least_jump);
        value == 0.0 || (is_high && goes_on) || times > 1
    };
    let path = |samples: &[f64]| -> f64 {
        let steps = samples.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        steps.sum::<f64>() / (samples.len().max(2) - 1) as f64
    };
    let mean_speed = path(&position.values);
    let moves = |run: &Range<usize>| {
        let at = |sample: usize| position.times.partition_point(|t| *t < force.times[sample]);
        let own = &position.values[at(run.start)..at(run.end - 1)];
        own.len() > 1 && path(own) > MIN_SPEED * mean_speed
    };
    let stale = long.iter().filter(|run| !is_level(run) && moves(run));
    stale.map(|run| run.start + 1..run.end).collect()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::recording::series::Wanted;

    fn series(values: Vec<f64>) -> Series {
        let wanted = Wanted {
            signal: "motor_torque".to_owned(),
            path: String::new(),
            unit: None,
            time: None,
        };
        let mut series = Series::new(&wanted, Path::new("a"));
        series.times = (0..values.len() as i64).map(|at| at * 5_000_000).collect();
        series.values = values;
        series
    }

    fn of_position(values: &[f64]) -> Vec<Range<usize>> {
        super::of_position(values, std::slice::from_ref(&(0..values.len())))
    }

    fn motion(at: usize) -> f64 {
        0.5 * (at as f64 * 0.003).sin()
    }

    #[test]
    fn a_position_that_is_sent_again_jumps_afterwards_and_one_at_rest_does_not() {
        let counts = |value: f64| (value / 1e-4).round() * 1e-4;
        let mut values: Vec<f64> = (0..4000).map(|at| counts(motion(at))).collect();
        assert!(of_position(&values).is_empty(), "reversals rest, too");
        let kept = values[100];
        values[100..160].fill(kept);
        let again = values[400];
        values[400..460].fill(again);
        let again = values[460];
        values[460..500].fill(again);
        assert_eq!(of_position(&values), [101..160, 401..460, 461..500]);
        // Stop, wait, go on.
        let waits = |at: usize| counts(motion(at.clamp(0, 300) + at.saturating_sub(700)));
        let values: Vec<f64> = (0..4000).map(waits).collect();
        assert!(of_position(&values).is_empty());
        // A slow motion that an encoder reads in steps.
        let values: Vec<f64> = (0..4000)
            .map(|at| (motion(at) / 0.02).round() * 0.02)
            .collect();
        assert!(of_position(&values).is_empty());
    }

    #[test]
    fn a_torque_that_is_sent_again_is_told_from_one_that_is_limited_or_off() {
        let position = series((0..4000).map(motion).collect());
        let torque = |at: usize| 6.0 * (at as f64 * 0.003).cos() + 0.01 * (at as f64).sin();
        let plain: Vec<f64> = (0..4000).map(torque).collect();
        let find = |values: Vec<f64>| of_force(&series(values), Some(&position));
        assert!(find(plain.clone()).is_empty());
        let mut stale = plain.clone();
        stale[600..700].fill(plain[600]);
        // One where torques may be limited.
        stale[900..1100].fill(plain[900]);
        assert_eq!(find(stale), [601..700, 901..1100]);
        let limited = plain.iter().map(|own| own.clamp(-4.0, 4.0)).collect();
        assert!(find(limited).is_empty());
        let mut off = plain.clone();
        off[900..1100].fill(0.0);
        assert!(find(off).is_empty());
        let coarse = plain.iter().map(|own| (own / 0.5).round() * 0.5).collect();
        assert!(find(coarse).is_empty());
    }
}
