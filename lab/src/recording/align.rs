//! Signals put on the position's time base and cut where one is missing.

use std::path::Path;

use ferntast_identification::{data::check::MIN_SAMPLES, numerics::statistics::quantile};

use super::{
    LoadError, Series,
    series::{GAP, VALID},
    tally::Tally,
};

/// Shorter stretches than this are left out \[samples\]: a fit takes none.
pub(super) const SHORTEST: usize = MIN_SAMPLES;

/// Sample times that deviate less than this part of a period from a uniform
/// grid are taken as uniform.
const UNIFORM: f64 = 0.1;

/// Slower than this is taken for a mistaken unit \[ns\].
const SLOWEST: i64 = 10_000_000_000;

/// A stretch with all signals, uniformly sampled.
pub(super) struct Piece {
    /// Time of the first sample \[ns\].
    pub(super) start: i64,
    /// \[s\].
    pub(super) period: f64,
    /// In the order of the series.
    pub(super) channels: Vec<Vec<f64>>,
}

impl Piece {
    /// When the sample after the last one would be \[ns\].
    pub(super) fn end(&self) -> i64 {
        let samples = self.channels.first().map_or(0, Vec::len);
        self.start + (samples as f64 * self.period * 1e9) as i64
    }
}

/// A series with its own period.
struct Timed<'a> {
    series: &'a Series,
    period: i64,
    /// How long its last value may stand for what follows \[ns\].
    hold: i64,
    /// Whether it is told when it changes: a value then stands until the next one.
    is_state: bool,
    /// The sample at or before the time that was asked for last.
    at: usize,
}

/// Cuts the series of one recording (the position first) into pieces; what is not
/// valid is in none of them. `tally` is told what becomes of the position's
/// samples. There may be no piece that is long enough.
pub(super) fn align(
    file: &Path,
    all: &[Series],
    tally: &mut Tally,
) -> Result<Vec<Piece>, LoadError> {
    let Some(position) = all.first() else {
        return Ok(Vec::new());
    };
    let period = position.median_interval().max(1);
    if period > SLOWEST {
        return Err(LoadError::TooSlow {
            signal: position.signal.clone(),
            file: file.to_owned(),
            period: period as f64 * 1e-9,
        });
    }
    let mut others: Vec<Timed> = all
        .iter()
        .skip(1)
        .map(|series| Timed::new(series, period))
        .collect();
    for other in &others {
        other.check_overlap(position)?;
    }
    let mut cut = Cutter {
        period,
        columns: vec![Vec::new(); all.len()],
        times: Vec::new(),
        pieces: Vec::new(),
        tally,
    };
    let valid = all.iter().position(|series| series.signal == VALID);
    let is_valid = |row: &[f64]| valid.and_then(|at| row.get(at)).is_none_or(|v| *v > 0.5);
    let mut row = vec![0.0; all.len()];
    for (&time, &value) in position.times.iter().zip(&position.values) {
        let mut complete = true;
        for (slot, value) in row.iter_mut().zip(
            std::iter::once(Some(value)).chain(others.iter_mut().map(|other| other.value(time))),
        ) {
            match value {
                Some(value) => *slot = value,
                None => complete = false,
            }
        }
        match (complete, is_valid(&row)) {
            (true, true) => cut.push(time, &row),
            (true, false) => {
                cut.tally.not_valid += 1;
                cut.close();
            }
            (false, _) => {
                cut.tally.without_other_signal += 1;
                cut.close();
            }
        }
    }
    cut.close();
    Ok(cut.pieces)
}

impl<'a> Timed<'a> {
    fn new(series: &'a Series, position_period: i64) -> Timed<'a> {
        let period = series.median_interval().max(1);
        Timed {
            series,
            period,
            // A slow signal (temperature) may stand for one period of its own;
            // a single sample for all time.
            hold: match series.times.len() {
                1 => i64::MAX,
                _ if period > 3 * position_period => period,
                _ => 0,
            },
            is_state: series.signal == VALID,
            at: 0,
        }
    }

    fn check_overlap(&self, position: &Series) -> Result<(), LoadError> {
        let ends = |series: &Series| {
            let first = series.times.first().copied().unwrap_or(0);
            (first, series.times.last().copied().unwrap_or(first))
        };
        let (from, to) = ends(self.series);
        let (position_from, position_to) = ends(position);
        let earliest = from.saturating_sub(self.hold_before());
        let is_in_time = self.is_state || to.saturating_add(self.hold) >= position_from;
        if earliest <= position_to && is_in_time {
            return Ok(());
        }
        // Seconds since the earlier of both, to be readable.
        let origin = from.min(position_from);
        let seconds = |time: i64| time.saturating_sub(origin) as f64 * 1e-9;
        Err(LoadError::NoOverlap {
            signal: self.series.signal.clone(),
            file: self.series.file.clone(),
            position_file: position.file.clone(),
            apart: seconds(from.max(position_from)) - seconds(to.min(position_to)),
            from: seconds(from),
            to: seconds(to),
            position_from: seconds(position_from),
            position_to: seconds(position_to),
        })
    }

    /// How long the first value may stand for what is before it \[ns\]: of a state that
    /// changes there is none that tells what it was.
    fn hold_before(&self) -> i64 {
        match self.is_state && self.series.times.len() > 1 {
            true => 0,
            false => self.hold,
        }
    }

    /// The value at `time`, which must not be before the last one asked for;
    /// `None` inside a gap and outside.
    fn value(&mut self, time: i64) -> Option<f64> {
        let times = &self.series.times;
        let value = |index: usize| self.series.values.get(index).copied();
        while times.get(self.at + 1).is_some_and(|&next| next <= time) {
            self.at += 1;
        }
        let before = *times.get(self.at)?;
        if time <= before {
            let near = before.saturating_sub(time) <= self.hold_before();
            return value(self.at).filter(|_| near);
        }
        if self.is_state {
            return value(self.at);
        }
        match times.get(self.at + 1) {
            Some(&after) if after.saturating_sub(before) <= GAP.saturating_mul(self.period) => {
                let part = (time - before) as f64 / (after - before) as f64;
                let (a, b) = (value(self.at)?, value(self.at + 1)?);
                Some(a + (b - a) * part)
            }
            _ if time.saturating_sub(before) <= self.hold => value(self.at),
            Some(&after) if after.saturating_sub(time) <= self.hold => value(self.at + 1),
            _ => None,
        }
    }
}

struct Cutter<'a> {
    period: i64,
    times: Vec<i64>,
    columns: Vec<Vec<f64>>,
    pieces: Vec<Piece>,
    tally: &'a mut Tally,
}

impl Cutter<'_> {
    fn push(&mut self, time: i64, row: &[f64]) {
        let last = self.times.last().copied();
        if last.is_some_and(|last| time.saturating_sub(last) > GAP * self.period) {
            self.close();
        }
        self.times.push(time);
        for (column, value) in self.columns.iter_mut().zip(row) {
            column.push(*value);
        }
    }

    /// Ends the stretch that is open.
    fn close(&mut self) {
        let times = std::mem::take(&mut self.times);
        let columns: Vec<Vec<f64>> = self.columns.iter_mut().map(std::mem::take).collect();
        let tally = &mut *self.tally;
        tally.longest = tally.longest.max(times.len());
        if times.is_empty() {
            return;
        }
        if times.len() < SHORTEST {
            tally.in_short_stretches += times.len();
            tally.short_stretches += 1;
            return;
        }
        let samples = times.len();
        let piece = uniform(&times, columns);
        let filled = piece.channels.first().map_or(0, Vec::len);
        tally.stretches += 1;
        tally.used += filled;
        tally.bridged += filled.saturating_sub(samples);
        self.pieces.push(piece);
    }
}

/// Steps of a uniform grid at which samples stand, where they stand on one and
/// some steps have none; with the period \[s\]. `None`, too, where that would be more than
/// ten steps without a sample for each one with: bursts far closer than what the recording's
/// gaps are judged by.
fn grid_with_holes(seconds: &[f64]) -> Option<(f64, Vec<usize>)> {
    let mut intervals: Vec<f64> = seconds.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let usual = quantile(&mut intervals, 0.5, f64::total_cmp)?;
    // Step by step, so that a period that is a little off does not add up.
    let most = seconds.len().saturating_mul(GAP as usize + 1);
    let mut steps = vec![0_usize];
    for pair in seconds.windows(2) {
        let last = steps.last().copied().unwrap_or(0);
        let step = ((pair[1] - pair[0]) / usual).round().max(1.0) as usize;
        let next = last.checked_add(step).filter(|next| *next <= most)?;
        steps.push(next);
    }
    let period = seconds.last()? / (*steps.last()?).max(1) as f64;
    let on_grid =
        |(step, time): (&usize, &f64)| (time - *step as f64 * period).abs() <= UNIFORM * period;
    let fits = steps.iter().zip(seconds).all(on_grid);
    fits.then_some((period, steps))
}

/// `column` with a straight line where `steps` leave some out.
fn bridged(column: &[f64], steps: &[usize]) -> Vec<f64> {
    let mut all = Vec::with_capacity(steps.last().map_or(0, |last| last + 1));
    for (values, steps) in column.windows(2).zip(steps.windows(2)) {
        let count = steps[1] - steps[0];
        let step = (values[1] - values[0]) / count as f64;
        all.extend((0..count).map(|k| values[0] + step * k as f64));
    }
    all.extend(column.last());
    all
}

/// The same on a uniform grid: as it is where it is uniform already, else
/// interpolated linearly.
fn uniform(times: &[i64], columns: Vec<Vec<f64>>) -> Piece {
    let start = times.first().copied().unwrap_or(0);
    let seconds: Vec<f64> = times
        .iter()
        .map(|&time| (time - start) as f64 * 1e-9)
        .collect();
    let end = seconds.last().copied().unwrap_or(0.0);
    let mean = end / (seconds.len().max(2) - 1) as f64;
    let on_grid =
        |(index, &time): (usize, &f64)| (time - index as f64 * mean).abs() <= UNIFORM * mean;
    if seconds.iter().enumerate().all(on_grid) {
        return Piece {
            start,
            period: mean,
            channels: columns,
        };
    }
    if let Some((period, steps)) = grid_with_holes(&seconds) {
        let channels = columns.iter().map(|column| bridged(column, &steps));
        return Piece {
            start,
            period,
            channels: channels.collect(),
        };
    }
    // The mean, not the median, where intervals are of two kinds: so as many
    // samples come out as went in.
    let (period, count) = (mean, seconds.len());
    let channels = columns
        .iter()
        .map(|column| {
            let mut at = 0;
            let sample = |index: usize| {
                let time = index as f64 * period;
                while seconds.get(at + 1).is_some_and(|&next| next < time) {
                    at += 1;
                }
                let (t0, t1) = (seconds.get(at), seconds.get(at + 1));
                let (x0, x1) = (column.get(at), column.get(at + 1));
                match (t0, t1, x0, x1) {
                    (Some(t0), Some(t1), Some(x0), Some(x1)) if t1 > t0 => {
                        x0 + (x1 - x0) * ((time - t0) / (t1 - t0)).clamp(0.0, 1.0)
                    }
                    _ => column.last().copied().unwrap_or_default(),
                }
            };
            (0..count).map(sample).collect()
        })
        .collect();
    Piece {
        start,
        period,
        channels,
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::{super::series::Wanted, *};

    fn cut(all: &[Series]) -> Result<(Vec<Piece>, Tally), LoadError> {
        let mut tally = Tally::default();
        Ok((align(Path::new("a"), all, &mut tally)?, tally))
    }

    fn series(signal: &str, times: Vec<i64>) -> Series {
        let wanted = Wanted {
            signal: signal.to_owned(),
            path: String::new(),
            unit: None,
            time: None,
        };
        let mut series = Series::new(&wanted, Path::new("a"));
        series.values = times.iter().map(|&time| time as f64 * 1e-9).collect();
        series.times = times;
        series
    }

    #[test]
    fn nothing_is_interpolated_across_a_gap_of_another_signal() {
        let ms = 1_000_000;
        let position = series("position", (0..400).map(|n| n * ms).collect());
        // Every 2 ms, and silent from 150 ms to 250 ms.
        let torque = (0..200)
            .map(|n| 2 * n * ms)
            .filter(|t| !(151 * ms..250 * ms).contains(t));
        let torque = series("motor_torque", torque.collect());
        let (pieces, tally) = cut(&[position, torque]).unwrap();
        let ranges: Vec<(i64, usize)> = pieces
            .iter()
            .map(|piece| (piece.start / ms, piece.channels[1].len()))
            .collect();
        assert_eq!(ranges, [(0, 151), (250, 149)]);
        let (used, without) = (tally.used, tally.without_other_signal);
        assert_eq!((used, without, tally.stretches), (300, 100, 2));
        for piece in &pieces {
            let pairs = piece.channels[0].iter().zip(&piece.channels[1]);
            assert!(pairs.into_iter().all(|(q, tau)| (q - tau).abs() < 1e-12));
        }
    }

    #[test]
    fn what_is_not_valid_is_cut_out() {
        let times: Vec<i64> = (0..300).map(|n| n * 10_000_000).collect();
        let position = series("position", times.clone());
        let mut valid = series(VALID, times);
        for (n, value) in valid.values.iter_mut().enumerate() {
            *value = f64::from(u8::from(!(100..200).contains(&n)));
        }
        let mut all = [position, valid];
        let (pieces, _) = cut(&all).unwrap();
        let starts: Vec<i64> = pieces.iter().map(|p| p.start / 10_000_000).collect();
        assert_eq!(starts, [0, 200]);
        assert!(pieces.iter().all(|piece| piece.channels[0].len() == 100));
        all[1].values.fill(0.0);
        let (pieces, tally) = cut(&all).unwrap();
        assert_eq!((pieces.len(), tally.not_valid, tally.longest), (0, 300, 0));
    }

    #[test]
    fn what_is_valid_is_so_until_the_flag_says_otherwise() {
        let ms = 1_000_000;
        let position = series("position", (0..3000).map(|n| n * 10 * ms).collect());
        // On from 2 s to 10 s, and from 20 s to the end: told when it changes.
        let mut flag = series(VALID, [2000, 10_000, 20_000].map(|at| at * ms).to_vec());
        flag.values = vec![1.0, 0.0, 1.0];
        let mut all = [position, flag];
        let ranges = |all: &[Series]| -> (Vec<(i64, usize)>, [usize; 2]) {
            let (pieces, tally) = cut(all).unwrap();
            let pieces = pieces.iter();
            let ranges = pieces.map(|own| (own.start / (10 * ms), own.channels[0].len()));
            (
                ranges.collect(),
                [tally.without_other_signal, tally.not_valid],
            )
        };
        let expected = (vec![(200, 800), (2000, 1000)], [200, 1000]);
        assert_eq!(ranges(&all), expected);
        // The same said every 500 ms.
        all[1].times = (4..60).map(|n| n * 500 * ms).collect();
        let is_on = |at: &i64| f64::from(u8::from(!(10_000..20_000).contains(&(at / ms))));
        all[1].values = all[1].times.iter().map(is_on).collect();
        assert_eq!(ranges(&all), expected);
        // Said once, it is so all the time, wherever it is said.
        (all[1].times, all[1].values) = (vec![40_000 * ms], vec![1.0]);
        assert_eq!(ranges(&all), (vec![(0, 3000)], [0, 0]));
        // Switched on before the recording begins.
        (all[1].times, all[1].values) = (vec![-9000 * ms, -8000 * ms], vec![0.0, 1.0]);
        assert_eq!(ranges(&all), (vec![(0, 3000)], [0, 0]));
    }

    #[test]
    fn a_short_hole_is_bridged_and_the_rest_stays_as_it_is() {
        let ms = 1_000_000;
        let times = (0..400).filter(|n| !(100..105).contains(n)).map(|n| n * ms);
        let mut position = series("position", times.collect());
        for (value, time) in position.values.iter_mut().zip(&position.times) {
            *value = (*time as f64 * 1e-7).sin();
        }
        let known = position.values.clone();
        let (pieces, tally) = cut(&[position]).unwrap();
        let [piece] = pieces.as_slice() else {
            panic!("{} pieces", pieces.len());
        };
        assert_eq!((tally.used, tally.bridged), (400, 5));
        assert!((piece.period - 1e-3).abs() < 1e-12);
        assert_eq!(piece.channels[0][..100], known[..100]);
        assert_eq!(piece.channels[0][105..], known[100..]);
        let middle = known[99] + (known[100] - known[99]) * 0.5;
        assert!((piece.channels[0][102] - middle).abs() < 1e-12);
    }

    #[test]
    fn bursts_with_pauses_far_longer_than_their_steps_do_not_fill_the_memory() {
        let ms = 1_000_000;
        // Every millisecond, then far behind it six samples a nanosecond apart every 9 ms.
        let even = (0..500).map(|n| n * ms);
        let bursts = (0..300).map(|n| 1000 * ms + n / 6 * 9 * ms + n % 6);
        let position = series("position", even.chain(bursts).collect());
        let (pieces, tally) = cut(&[position]).unwrap();
        let lengths: Vec<usize> = pieces.iter().map(|own| own.channels[0].len()).collect();
        assert_eq!((lengths, tally.bridged), (vec![500, 300], 0));
        // Bursts and pauses together: 49 × 9 ms and 5 ns in 299 steps.
        let mean = (49.0 * 9e-3 + 5e-9) / 299.0;
        assert!((pieces[1].period / mean - 1.0).abs() < 1e-12);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        /// Whatever the times are: pieces are whole, long enough, and hold
        /// nothing but what was there.
        #[test]
        fn any_times_give_whole_pieces(
            steps in prop::collection::vec(prop_oneof![
                30 => 900_000..1_100_000i64,
                1 => 1..i64::MAX / 400,
            ], 60..300),
            slow in prop::collection::vec(1..50_000_000i64, 1..60),
            first in prop_oneof![Just(0), Just(i64::MIN / 2), any::<i32>().prop_map(i64::from)],
        ) {
            let sum = |steps: &[i64]| -> Vec<i64> {
                steps.iter().scan(first, |time, step| {
                    *time = time.saturating_add(*step);
                    Some(*time)
                }).collect()
            };
            let all = [series("position", sum(&steps)), series("temperature", sum(&slow))];
            if let Ok((pieces, tally)) = cut(&all) {
                let left_out = tally.without_other_signal + tally.in_short_stretches;
                prop_assert_eq!(tally.used - tally.bridged + left_out, all[0].times.len());
                for piece in pieces {
                    prop_assert!(piece.period > 0.0);
                    prop_assert!(piece.channels.iter().all(|c| c.len() == piece.channels[0].len()));
                    prop_assert!(piece.channels[0].len() >= SHORTEST);
                    let (low, high) = (all[1].values[0], all[1].values[all[1].values.len() - 1]);
                    prop_assert!(piece.channels[1].iter().all(|&v| low <= v && v <= high));
                }
            }
        }
    }
}
