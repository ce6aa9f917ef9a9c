//! Samples that were taken regularly and have the time of their arrival.

use std::ops::Range;

use ferntast_identification::numerics::statistics::quantile;

use super::{OTHERWISE, steps::Steps};
use crate::recording::series::{GAP, Series, split};

/// Times off a regular clock by less than this part of a period are regular.
const REGULAR: f64 = 0.1;
/// On the regular clock the position is smoother by this factor at least.
const MAX_ROUGHNESS: f64 = 0.5;
/// With the given times it is rougher than so many of the position's smallest steps.
const TIMES_LEAST: f64 = 2.0;
/// Share of a deviation by which the clock that is followed is set.
const FOLLOW: f64 = 0.1;
/// Fewest samples that tell.
const FEWEST: usize = 100;

/// Gives samples the times of a regular clock where the position is at least twice as smooth
/// on that, between gaps each its own: the noise of the times was none of the motion. All series
/// with the position's times get the new ones; a note tells it.
pub(super) fn set_right(all: &mut [Series]) -> Option<String> {
    let position = all.first()?;
    let seconds = position.seconds();
    let start = position.times.first().copied()?;
    let mut times = position.times.clone();
    let mut told: Option<(f64, f64)> = None;
    for stretch in stretches(&seconds) {
        let own = seconds.get(stretch.clone()).unwrap_or_default();
        let values = position.values.get(stretch.clone()).unwrap_or_default();
        let Some(clock) = regular(own, values) else {
            continue;
        };
        let (scatter, _) = told.unwrap_or_default();
        told = Some((f64::max(scatter, clock.scatter), clock.period));
        let both = times.iter_mut().skip(stretch.start).zip(&clock.times);
        both.for_each(|(time, own)| *time = start + (own * 1e9).round() as i64);
    }
    let (scatter, period) = told?;
    // Clocks of neighbouring stretches may overlap by what their times scatter.
    let is_in_order = times.windows(2).all(|pair| pair[0] < pair[1]);
    let note = format!(
        "{}: the times of signals.{} scatter by up to {:.3} ms (rms) about a clock of {:.3} ms, on which the motion is smooth: samples get its times{OTHERWISE}",
        position.file.display(),
        position.signal,
        scatter * 1e3,
        period * 1e3,
    );
    let old = position.times.clone();
    for own in all.iter_mut().filter(|own| is_in_order && own.times == old) {
        own.times.clone_from(&times);
    }
    is_in_order.then_some(note)
}

/// Samples between gaps; times of too few digits are the same of several samples.
fn stretches(seconds: &[f64]) -> Vec<Range<usize>> {
    let mut intervals: Vec<f64> = seconds.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let longest = GAP as f64 * usual(&mut intervals);
    let is_gap = |at: &usize| seconds[*at] - seconds[at - 1] > longest;
    split(seconds.len(), is_gap).collect()
}

/// The usual one of `intervals`: the median, unless most are far shorter.
fn usual(intervals: &mut [f64]) -> f64 {
    let mean = intervals.iter().sum::<f64>() / intervals.len().max(1) as f64;
    let median = quantile(intervals, 0.5, f64::total_cmp).unwrap_or(0.0);
    if median > 0.0 { median } else { mean }
}

/// A regular clock beside the times that samples have.
struct Clock {
    /// Of each sample \[s\].
    times: Vec<f64>,
    /// How far the samples' own times are from these, rms and at most \[s\].
    scatter: f64,
    most: f64,
    /// \[s\].
    period: f64,
}

impl Clock {
    /// Whether the samples have its times.
    fn is_regular(&self) -> bool {
        self.most <= REGULAR * self.period
    }

    /// Whether no sample's time is further from its own than a gap is long, and some are off.
    fn is_off_by_no_gap(&self) -> bool {
        self.period > 0.0 && !self.is_regular() && self.most < GAP as f64 * self.period
    }
}

/// The regular clock on which `values` are smooth; `None` where the times that there are are
/// better, or regular.
fn regular(seconds: &[f64], values: &[f64]) -> Option<Clock> {
    if seconds.len() < FEWEST {
        return None;
    }
    let mut intervals: Vec<f64> = seconds.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let usual = usual(&mut intervals);
    if usual <= 0.0 {
        return None;
    }
    let all_there: Vec<usize> = (0..seconds.len()).collect();
    let without_losses = on_line(&all_there, seconds);
    if without_losses.is_regular() {
        return None;
    }
    // The period of the first time follows the better the second time.
    let (_, period) = line(&followed(seconds, usual), seconds);
    let with_losses = on_line(&followed(seconds, period), seconds);
    let clocks = [without_losses, with_losses].into_iter();
    let found = clocks.filter(Clock::is_off_by_no_gap);
    let found = found.map(|clock| (Roughness::of(&clock.times, values), clock));
    // A sample that was lost shows in few places.
    let (rough, clock) = found.min_by(|a, b| a.0.mean.total_cmp(&b.0.mean))?;
    let said = Roughness::of(seconds, values).median;
    // What a coarse encoder does not show does no harm.
    let is_seen = said > TIMES_LEAST * Steps::of(values).least;
    (is_seen && rough.median < MAX_ROUGHNESS * said).then_some(clock)
}

/// The step of a clock that each sample is nearest to; the clock is set a little by every
/// sample.
fn followed(seconds: &[f64], period: f64) -> Vec<usize> {
    let mut now = seconds.first().copied().unwrap_or(0.0);
    let mut step = 0;
    let each = seconds.iter().enumerate().map(|(at, time)| {
        if at > 0 {
            let passed = ((time - now) / period).round().max(1.0);
            step += passed as usize;
            now += passed * period;
            now += FOLLOW * (time - now);
        }
        step
    });
    each.collect()
}

/// Height at step 0 and slope of the straight line through `seconds` over `steps`.
fn line(steps: &[usize], seconds: &[f64]) -> (f64, f64) {
    let count = seconds.len() as f64;
    let mean_step = steps.iter().map(|step| *step as f64).sum::<f64>() / count;
    let mean_time = seconds.iter().sum::<f64>() / count;
    let (mut over, mut square) = (0.0, 0.0);
    for (step, time) in steps.iter().zip(seconds) {
        let step = *step as f64 - mean_step;
        over += step * (time - mean_time);
        square += step * step;
    }
    let slope = over / square;
    (mean_time - slope * mean_step, slope)
}

/// The clock of that line.
fn on_line(steps: &[usize], seconds: &[f64]) -> Clock {
    let (height, period) = line(steps, seconds);
    let times: Vec<f64> = (steps.iter())
        .map(|step| height + period * *step as f64)
        .collect();
    let (mut most, mut sum) = (0.0, 0.0);
    for (own, said) in times.iter().zip(seconds) {
        let off = (own - said).abs();
        most = f64::max(most, off);
        sum += off * off;
    }
    Clock {
        times,
        scatter: (sum / seconds.len() as f64).sqrt(),
        most,
        period,
    }
}

/// Distances of values from the lines between their neighbours.
struct Roughness {
    median: f64,
    mean: f64,
}

impl Roughness {
    fn of(seconds: &[f64], values: &[f64]) -> Self {
        let three = seconds.windows(3).zip(values.windows(3));
        let mut off: Vec<f64> = three
            .filter_map(|(t, x)| {
                let (t, x) = (<[f64; 3]>::try_from(t).ok()?, <[f64; 3]>::try_from(x).ok()?);
                let share = (t[1] - t[0]) / (t[2] - t[0]).max(1e-300);
                Some((x[1] - x[0] - share * (x[2] - x[0])).abs())
            })
            .collect();
        Self {
            mean: off.iter().sum::<f64>() / off.len().max(1) as f64,
            median: quantile(&mut off, 0.5, f64::total_cmp).unwrap_or(0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD: f64 = 0.005;

    /// Between -0.5 and 0.5.
    fn scatter(at: usize) -> f64 {
        let mixed = (at as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        ((mixed ^ (mixed >> 32)) >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    }

    fn motion(time: f64) -> f64 {
        0.5 * (0.7 * time).sin() + 0.1 * (3.0 * time).sin()
    }

    /// Whether a clock is found, and how far its times are from the true ones at most.
    fn found(taken: &[f64], said: &[f64]) -> Option<f64> {
        let values: Vec<f64> = taken.iter().map(|time| motion(*time)).collect();
        let times = regular(said, &values)?.times;
        let apart = |at: usize| (times[at] - times[0]) - (taken[at] - taken[0]);
        Some(
            (0..times.len())
                .map(|at| apart(at).abs())
                .fold(0.0, f64::max),
        )
    }

    #[test]
    fn times_of_arrival_are_told_from_times_of_measurement() {
        let taken: Vec<f64> = (0..4000).map(|at| at as f64 * PERIOD).collect();
        let late = |(at, time): (usize, &f64)| time + 0.8 * PERIOD * scatter(at);
        let said: Vec<f64> = taken.iter().enumerate().map(late).collect();
        let off = found(&taken, &said).expect("arrivals scatter");
        assert!(off < 0.05 * PERIOD, "{off}");
        // Measured when it says.
        assert_eq!(found(&said, &said), None);
        assert_eq!(found(&taken, &taken), None);
    }

    #[test]
    fn times_of_too_few_digits_are_set_right() {
        let taken: Vec<f64> = (0..4000).map(|at| at as f64 * PERIOD).collect();
        for digits in [0.01, 0.02] {
            let said: Vec<f64> = taken
                .iter()
                .map(|t| (t / digits).round() * digits)
                .collect();
            let off = found(&taken, &said).expect("several samples have one time");
            assert!(off < 0.1 * PERIOD, "{off} with {digits}");
        }
    }

    #[test]
    fn samples_that_were_lost_leave_their_steps() {
        let there = (0..4000).filter(|at| at % 17 != 3);
        let taken: Vec<f64> = there.map(|at| at as f64 * PERIOD).collect();
        let late = |(at, time): (usize, &f64)| time + 0.7 * PERIOD * scatter(at);
        let said: Vec<f64> = taken.iter().enumerate().map(late).collect();
        let off = found(&taken, &said).expect("arrivals scatter");
        assert!(off < 0.2 * PERIOD, "{off}");
    }
}
