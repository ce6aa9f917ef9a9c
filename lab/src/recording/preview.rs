//! Signals as they are recorded, to be looked at before anything is made of them.

use std::path::PathBuf;

use serde::Serialize;

use super::{LoadError, Series, read_series, series::GAP, wanted};
use crate::experiment::Experiment;

/// Points of a curve at most; a chart has fewer columns.
const MOST: usize = 1200;

/// One signal of one recording.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Seen {
    /// The signal's key; of an arm's joint `position@elbow`.
    pub signal: String,
    /// The recording.
    pub recording: PathBuf,
    /// The unit that it is in after conversion; empty where it has none.
    pub unit: String,
    /// Samples with a number and a time of their own.
    pub samples: usize,
    /// Samples with neither number nor time (NaN, empty).
    pub missing: usize,
    /// Where the first of these is.
    pub first_missing: Option<String>,
    /// Samples with the time of the one before.
    pub repeated: usize,
    /// Least and greatest value.
    pub range: Option<[f64; 2]>,
    /// The first time \[s\].
    pub first: f64,
    /// Median interval \[s\].
    pub interval: f64,
    /// Intervals more than ten times as long.
    pub gaps: usize,
    /// The longest of these \[s\]; 0 without one.
    pub longest_gap: f64,
    /// Times of the curve \[s\] from the recording's beginning.
    pub time: Vec<f64>,
    /// Its values, least and greatest of each stretch; not finite within a gap.
    pub value: Vec<f32>,
}

/// Signals of all recordings of `experiment`, and why some cannot be read. One that
/// has no path yet is left out.
#[must_use]
pub fn preview(experiment: &Experiment) -> (Vec<Seen>, Vec<LoadError>) {
    let mut wanted = wanted(experiment);
    wanted.retain(|own| !own.path.is_empty());
    let (mut seen, mut troubles) = (Vec::new(), Vec::new());
    let lists = [
        &experiment.recordings,
        &experiment.unloaded,
        &experiment.held_out,
    ];
    for recording in lists.into_iter().flatten() {
        let mut all = Vec::new();
        let mut notes = Vec::new();
        match read_series(experiment, recording, &wanted, &mut notes) {
            Ok((series, _)) => all = series,
            // One that cannot be read does not hide the others.
            Err(_) => {
                for own in wanted.iter().map(std::slice::from_ref) {
                    match read_series(experiment, recording, own, &mut notes) {
                        Ok((mut series, _)) => all.append(&mut series),
                        Err(error) => troubles.push(error),
                    }
                }
            }
        }
        all.iter_mut().for_each(Series::drop_repeated);
        let starts = all.iter().filter_map(|own| own.times.first().copied());
        let start = starts.min().unwrap_or(0);
        seen.extend(all.iter().map(|own| {
            let key = experiment.key_in_arm(&own.signal);
            let signal = key.unwrap_or_else(|| own.signal.clone());
            Seen {
                recording: recording.clone(),
                unit: experiment.unit_of(&signal),
                signal,
                ..of_series(own, start)
            }
        }));
    }
    (seen, troubles)
}

fn of_series(series: &Series, start: i64) -> Seen {
    let period = series.median_interval();
    let longest = GAP.saturating_mul(period.max(1));
    let intervals = series.times.windows(2);
    let gaps = intervals.map(|pair| pair[1].saturating_sub(pair[0]));
    let gaps: Vec<i64> = gaps.filter(|interval| *interval > longest).collect();
    let seconds = |time: i64| time as f64 * 1e-9;
    let least = series.values.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = series
        .values
        .iter()
        .copied()
        .fold(f64::NEG_INFINITY, f64::max);
    let (time, value) = curve(series, start, longest);
    Seen {
        signal: series.signal.clone(),
        recording: PathBuf::new(),
        unit: String::new(),
        samples: series.values.len(),
        missing: series.missing,
        first_missing: series.first_missing.clone(),
        repeated: series.repeated,
        range: (least <= greatest).then_some([least, greatest]),
        first: series.times.first().map_or(0.0, |time| seconds(*time)),
        interval: seconds(period),
        gaps: gaps.len(),
        longest_gap: gaps.iter().max().map_or(0.0, |gap| seconds(*gap)),
        time,
        value,
    }
}

/// Least and greatest value of each stretch, in their order.
fn curve(series: &Series, start: i64, longest: i64) -> (Vec<f64>, Vec<f32>) {
    let stretch = series.values.len().div_ceil(MOST / 2).max(1);
    let (mut times, mut values) = (Vec::new(), Vec::new());
    let mut last: Option<i64> = None;
    let points = series.times.iter().zip(&series.values);
    let points: Vec<(i64, f64)> = points.map(|(time, value)| (*time, *value)).collect();
    for part in points.chunks(stretch) {
        let by_value = |a: &&(i64, f64), b: &&(i64, f64)| a.1.total_cmp(&b.1);
        let (Some(least), Some(most)) =
            (part.iter().min_by(by_value), part.iter().max_by(by_value))
        else {
            continue;
        };
        let mut kept = vec![*least, *most];
        kept.sort_by_key(|(time, _)| *time);
        kept.dedup_by_key(|(time, _)| *time);
        for (time, value) in kept {
            let apart = longest.max(2 * i64::try_from(stretch).unwrap_or(1) * (longest / GAP));
            if last.is_some_and(|last| time.saturating_sub(last) > apart) {
                times.push(micro(time, start));
                values.push(f32::NAN);
            }
            times.push(micro(time, start));
            values.push(value as f32);
            last = Some(time);
        }
    }
    (times, values)
}

/// \[s\] from `start`, to the microsecond.
fn micro(time: i64, start: i64) -> f64 {
    (time.saturating_sub(start) as f64 * 1e-3).round() * 1e-6
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{super::Wanted, *};

    fn series(count: i64, gap: std::ops::Range<i64>) -> Series {
        let wanted = Wanted {
            signal: "position".to_owned(),
            path: "q".to_owned(),
            unit: None,
            time: None,
        };
        let mut series = Series::new(&wanted, Path::new("a.csv"));
        for row in (0..count).filter(|row| !gap.contains(row)) {
            let value = if row == 777 { 9.0 } else { 0.0 };
            series.push(row * 1_000_000, value, String::new).unwrap();
        }
        series
    }

    #[test]
    fn a_long_curve_keeps_its_peak_and_its_gap() {
        let seen = of_series(&series(100_000, 40_000..50_000), 0);
        assert!(
            (MOST / 4..=MOST + 2).contains(&seen.time.len()),
            "{}",
            seen.time.len()
        );
        assert_eq!(seen.time.len(), seen.value.len());
        assert_eq!(seen.value.iter().copied().fold(0.0, f32::max), 9.0);
        assert_eq!(seen.value.iter().filter(|own| own.is_nan()).count(), 1);
        assert_eq!((seen.samples, seen.gaps), (90_000, 1));
        assert!(
            (seen.longest_gap - 10.001).abs() < 1e-9,
            "{}",
            seen.longest_gap
        );
        assert!((seen.interval - 1e-3).abs() < 1e-12);
        assert_eq!(seen.range, Some([0.0, 9.0]));
    }

    #[test]
    fn a_short_one_stays_as_it_is() {
        let seen = of_series(&series(100, 0..0), 0);
        assert_eq!(seen.time.len(), 100);
        assert_eq!((seen.gaps, seen.longest_gap), (0, 0.0));
        let nothing = of_series(&series(0, 0..0), 0);
        assert_eq!((nothing.range, nothing.interval), (None, 0.0));
    }
}
