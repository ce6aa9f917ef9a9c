//! Readings that stand alone: away, and back again.

use std::{
    cell::OnceCell,
    ops::{Range, RangeInclusive},
};

use ferntast_identification::numerics::statistics::quantile;

use super::{Kind, in_each, steps::Steps};

/// Longest spike of a torque \[samples\]: a blow may last longer.
const LONGEST: usize = 2;
/// The same of a position, which cannot jump.
const LONGEST_OF_POSITION: usize = 10;
/// A spike is so many times as high as all but one in a hundred of the signal's own
/// turns from one sample to the next …
const TIMES_TURNS: f64 = 8.0;
/// … of a torque so many times as high as all but one in a hundred steps, …
const TIMES_STEPS: f64 = 6.0;
/// … and more than so many of its smallest steps.
const TIMES_LEAST: f64 = 3.0;

/// A torque or temperature that jumps within the range that it has but for this share of both
/// ends may have done so, unless it reads zero.
const TAILS: f64 = 0.005;
/// Meanwhile the signal went on by so many times its usual steps, at most.
const MAX_WAY: f64 = 2.0;

/// Spikes of a signal.
#[derive(Debug, PartialEq)]
pub(super) struct Spikes {
    /// Their samples.
    pub(super) runs: Vec<Range<usize>>,
    /// How high they are at least.
    pub(super) threshold: f64,
    /// Steps are no larger otherwise, but for one in a hundred.
    pub(super) usual: f64,
}

/// Finds what jumps further than the signal does otherwise and comes back to where it was
/// going, within a stretch without a gap; at the ends of one, what jumps alone.
pub(super) fn find(values: &[f64], stretches: &[Range<usize>], kind: Kind) -> Spikes {
    let steps = Steps::of(values);
    let mut turns: Vec<f64> = values
        .windows(3)
        .map(|three| match three {
            [a, b, c] if (b - a) * (c - b) < 0.0 => (b - a).abs().min((c - b).abs()),
            _ => 0.0,
        })
        .collect();
    let turn = quantile(&mut turns, 0.99, f64::total_cmp).unwrap_or(0.0);
    let (longest, by_steps) = match kind {
        Kind::Position => (LONGEST_OF_POSITION, 1.0),
        Kind::Force | Kind::Slow => (LONGEST, TIMES_STEPS),
    };
    let threshold = (by_steps * steps.usual)
        .max(TIMES_TURNS * turn)
        .max(TIMES_LEAST * steps.least);
    let mut found = Spikes {
        runs: Vec::new(),
        threshold,
        usual: steps.usual,
    };
    if threshold == 0.0 {
        return found;
    }
    let range = OnceCell::new();
    found.runs = in_each(values, stretches, |own| {
        let mut runs = within(own, &found, longest);
        match kind {
            Kind::Position => at_ends(own, &found, &mut runs),
            Kind::Force | Kind::Slow => {
                let may_be = |value: &f64| {
                    let range = range.get_or_init(|| possible(values, threshold));
                    *value != 0.0 && range.contains(value)
                };
                runs.retain(|run| !own[run.clone()].iter().any(may_be));
            }
        }
        runs
    });
    found
}

/// The range of most of the `values`, and the `threshold` beyond: blows are within it.
fn possible(values: &[f64], threshold: f64) -> RangeInclusive<f64> {
    let mut sorted = values.to_vec();
    let mut at = |share| quantile(&mut sorted, share, f64::total_cmp).unwrap_or(0.0);
    at(TAILS) - threshold..=at(1.0 - TAILS) + threshold
}

/// Spikes of one stretch, in order.
fn within(values: &[f64], of: &Spikes, longest: usize) -> Vec<Range<usize>> {
    let (threshold, usual) = (of.threshold, of.usual);
    let mut runs: Vec<Range<usize>> = Vec::new();
    let mut at = 1;
    while at + 1 < values.len() {
        let is_jump = (values[at] - values[at - 1]).abs() > threshold;
        let end = is_jump.then(|| {
            let last = (at + longest + 1).min(values.len());
            (at + 1..last).find(|end| is_spike(&values[at - 1..=*end], threshold, usual))
        });
        match end.flatten() {
            Some(end) => {
                runs.push(at..end);
                at = end + 1;
            }
            None => at += 1,
        }
    }
    runs
}

/// Samples at the ends of a stretch that a position jumps from or to: there is nothing to come
/// back to, or from, and `runs` have none of them.
fn at_ends(values: &[f64], of: &Spikes, runs: &mut Vec<Range<usize>>) {
    let least = of.threshold.max(TIMES_STEPS * of.usual);
    let is_alone = |at: &usize| {
        let is_known = runs.iter().any(|run| run.start == *at || run.end == *at);
        !is_known && (values[*at] - values[at - 1]).abs() > least
    };
    let early = 1..(LONGEST_OF_POSITION + 1).min(values.len());
    let late = values.len().saturating_sub(LONGEST_OF_POSITION);
    let mut late = late.max(early.end)..values.len();
    let head = early.rev().find(is_alone);
    let tail = late.find(is_alone);
    if let Some(end) = head {
        runs.retain(|run| run.start > end);
        runs.insert(0, 0..end);
    }
    if let Some(start) = tail {
        runs.retain(|run| run.end < start);
        runs.push(start..values.len());
    }
}

/// Whether all but the first and the last stand off the line from that to this on one side,
/// and these are as far apart as the signal may have moved.
fn is_spike(values: &[f64], threshold: f64, usual: f64) -> bool {
    let [first, between @ .., last] = values else {
        return false;
    };
    let steps = (between.len() + 1) as f64;
    let slope = (last - first) / steps;
    let off = |(at, value): (usize, &f64)| value - (first + slope * (at as f64 + 1.0));
    let all = |sign: f64| {
        let mut each = between.iter().enumerate().map(off);
        each.all(|off| sign * off > threshold)
    };
    (last - first).abs() <= MAX_WAY * steps * usual && (all(1.0) || all(-1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn find(values: &[f64], kind: Kind) -> Spikes {
        super::find(values, std::slice::from_ref(&(0..values.len())), kind)
    }

    fn noise(at: usize) -> f64 {
        // A number between -0.5 and 0.5 by Weyl's sequence.
        (at as f64 * 0.618_033_988_749_895).fract() - 0.5
    }

    #[test]
    fn what_jumps_and_comes_back_is_found_and_nothing_else() {
        let clean: Vec<f64> = (0..5000)
            .map(|at| {
                let angle = at as f64 * 0.01;
                5.0 * angle.cos().signum() + 3.0 * angle.cos() + 0.2 * noise(at)
            })
            .collect();
        assert!(find(&clean, Kind::Force).runs.is_empty());
        let mut spoilt = clean.clone();
        spoilt[700] += 40.0;
        spoilt[1500] -= 30.0;
        spoilt[1501] -= 35.0;
        spoilt[2100] = 0.0;
        let found = find(&spoilt, Kind::Force).runs;
        assert_eq!(found, [700..701, 1500..1502, 2100..2101]);
        // A blow within the range that there is.
        spoilt[2100] = -clean[2100];
        assert_eq!(find(&spoilt, Kind::Force).runs, found[..2]);
        // A step stays one, and so does what lasts.
        let mut step = clean;
        step[2000..2010].iter_mut().for_each(|own| *own += 40.0);
        step[4000..].iter_mut().for_each(|own| *own += 40.0);
        assert!(find(&step, Kind::Force).runs.is_empty());
    }

    #[test]
    fn a_position_that_reads_zero_for_some_samples_is_wrong() {
        let motion = |at: usize| 0.4 + 0.3 * (at as f64 * 0.004).sin();
        for quantum in [0.0, 1e-3] {
            let read = |at: usize| match quantum > 0.0 {
                true => (motion(at) / quantum).round() * quantum,
                false => motion(at) + 1e-5 * noise(at),
            };
            let mut values: Vec<f64> = (0..5000).map(read).collect();
            assert!(find(&values, Kind::Position).runs.is_empty());
            for wrong in [0..2, 300..301, 900..908, 4999..5000] {
                values[wrong].fill(0.0);
            }
            let found = find(&values, Kind::Position).runs;
            assert_eq!(found, [0..2, 300..301, 900..908, 4999..5000]);
            // Where a gap has been, the joint is elsewhere.
            let mut apart: Vec<f64> = (0..2000).map(read).collect();
            apart.extend((2600..2605).chain(2900..4000).map(read));
            let stretches = [0..2000, 2000..2005, 2005..apart.len()];
            let found = super::find(&apart, &stretches, Kind::Position).runs;
            assert!(found.is_empty(), "{found:?}");
        }
    }

    #[test]
    fn noise_alone_has_no_spikes() {
        let mut random = 1_u64;
        let mut uniform = || {
            random = random
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (random >> 11) as f64 / (1_u64 << 53) as f64
        };
        let normal: Vec<f64> = (0..200_000)
            .map(|_| {
                (-2.0 * uniform().max(1e-12).ln()).sqrt()
                    * (std::f64::consts::TAU * uniform()).cos()
            })
            .collect();
        for kind in [Kind::Position, Kind::Force] {
            assert!(find(&normal, kind).runs.is_empty());
        }
        for constant in [&[][..], &[1.0], &[2.0; 50]] {
            assert!(find(constant, Kind::Position).runs.is_empty());
        }
    }
}
