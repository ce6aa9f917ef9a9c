//! One signal as it was recorded.

use std::{
    ops::Range,
    path::{Path, PathBuf},
};

use ferntast_identification::numerics::statistics::quantile;

use super::error::LoadError;
use crate::unit::Unit;

/// The signal that says which samples count.
pub(super) const VALID: &str = "valid";

/// The tip's coordinates as signals.
pub(super) const TIP_X: &str = "tip[0]";
pub(super) const TIP_Y: &str = "tip[1]";

/// An interval more than that many periods long is a gap.
pub(super) const GAP: i64 = 10;

/// A signal to be read.
pub(super) struct Wanted {
    pub(super) signal: String,
    /// Message path or column.
    pub(super) path: String,
    /// The unit of what the path gives, where it is stated.
    pub(super) unit: Option<Unit>,
    /// The column that is this signal's own time.
    pub(super) time: Option<String>,
}

/// One signal as it was recorded.
#[derive(Debug)]
pub(super) struct Series {
    pub(super) signal: String,
    pub(super) file: PathBuf,
    unit: Option<Unit>,
    /// \[ns\], ascending, several samples at one time until
    /// [`drop_repeated`](Self::drop_repeated).
    pub(super) times: Vec<i64>,
    pub(super) values: Vec<f64>,
    /// Samples without a number.
    pub(super) missing: usize,
    /// Where the first of them is.
    pub(super) first_missing: Option<String>,
    /// Samples with the time of the one before.
    pub(super) repeated: usize,
}

impl Series {
    pub(super) fn new(wanted: &Wanted, file: &Path) -> Series {
        Series {
            signal: wanted.signal.clone(),
            file: file.to_owned(),
            unit: wanted.unit,
            times: Vec::new(),
            values: Vec::new(),
            missing: 0,
            first_missing: None,
            repeated: 0,
        }
    }

    /// Counts a sample without a number; `place` names it.
    pub(super) fn miss(&mut self, place: impl Fn() -> String) {
        self.missing += 1;
        self.first_missing.get_or_insert_with(place);
    }

    /// Takes a sample; `place` names it in errors.
    pub(super) fn push(
        &mut self,
        time: i64,
        value: f64,
        place: impl Fn() -> String,
    ) -> Result<(), LoadError> {
        if !value.is_finite() {
            self.miss(place);
            return Ok(());
        }
        match self.times.last() {
            Some(&last) if time < last => Err(LoadError::Backwards {
                signal: self.signal.clone(),
                file: self.file.clone(),
                place: place(),
                by: last.saturating_sub(time) as f64 * 1e-9,
            }),
            _ => {
                self.times.push(time);
                let value = self.unit.map_or(value, |unit| unit.convert(value));
                self.values.push(value);
                Ok(())
            }
        }
    }

    /// Leaves out and counts what has the time of the sample before, as if it were that one sent
    /// again.
    pub(super) fn drop_repeated(&mut self) {
        let is_repeated = |at: &usize| self.times[*at] == self.times[at - 1];
        let repeated: Vec<usize> = (1..self.times.len()).filter(is_repeated).collect();
        let runs: Vec<Range<usize>> = repeated.iter().map(|at| *at..at + 1).collect();
        self.repeated = repeated.len();
        if self.repeated > 0 {
            self.remove(&runs);
        }
    }

    /// Takes out these samples, which are ranges in order.
    pub(super) fn remove(&mut self, runs: &[Range<usize>]) {
        retain_outside(&mut self.times, runs);
        retain_outside(&mut self.values, runs);
    }

    /// Samples between gaps.
    pub(super) fn stretches(&self) -> Vec<Range<usize>> {
        let longest = GAP.saturating_mul(self.median_interval());
        let is_gap = |at: &usize| self.times[*at].saturating_sub(self.times[at - 1]) > longest;
        split(self.times.len(), is_gap).collect()
    }

    /// Times \[s\] since the first sample.
    pub(super) fn seconds(&self) -> Vec<f64> {
        (0..self.times.len())
            .map(|at| self.since_start(at))
            .collect()
    }

    /// Time of one sample \[s\] since the first.
    pub(super) fn since_start(&self, at: usize) -> f64 {
        let time = |at: usize| self.times.get(at).copied().unwrap_or(0);
        time(at).saturating_sub(time(0)) as f64 * 1e-9
    }

    /// Median interval \[s\]; 0 without two samples.
    pub(super) fn interval(&self) -> f64 {
        self.median_interval() as f64 * 1e-9
    }

    /// The same \[ns\].
    pub(super) fn median_interval(&self) -> i64 {
        let pairs = self.times.windows(2);
        let mut intervals: Vec<i64> = pairs.map(|pair| pair[1].saturating_sub(pair[0])).collect();
        quantile(&mut intervals, 0.5, i64::cmp).unwrap_or(0)
    }
}

/// Places 0 … `count` − 1 in ranges, of which each but the first begins where `begins` says.
pub(super) fn split(
    count: usize,
    begins: impl FnMut(&usize) -> bool,
) -> impl Iterator<Item = Range<usize>> {
    let ends = (1..count).filter(begins);
    let mut from = 0;
    ends.chain((count > 0).then_some(count))
        .map(move |end| std::mem::replace(&mut from, end)..end)
}

fn retain_outside<T>(all: &mut Vec<T>, runs: &[Range<usize>]) {
    let mut next = runs.iter().peekable();
    let mut at = 0;
    all.retain(|_| {
        while next.next_if(|run| run.end <= at).is_some() {}
        let is_outside = next.peek().is_none_or(|run| at < run.start);
        at += 1;
        is_outside
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_taken_out_with_their_times() {
        let wanted = Wanted {
            signal: "position".to_owned(),
            path: String::new(),
            unit: None,
            time: None,
        };
        let mut series = Series::new(&wanted, Path::new("a"));
        series.times = (0..8).map(|at| 1_000_000_000 * at).collect();
        series.values = (0..8).map(f64::from).collect();
        series.remove(&[1..3, 3..4, 7..8]);
        assert_eq!(series.values, [0.0, 4.0, 5.0, 6.0]);
        assert_eq!(series.seconds(), series.values);
    }

    #[test]
    fn what_is_no_number_is_counted_and_what_is_one_converted() {
        let wanted = Wanted {
            signal: "position".to_owned(),
            path: "q".to_owned(),
            unit: Unit::parse("mm"),
            time: None,
        };
        let mut series = Series::new(&wanted, Path::new("a"));
        for (at, value) in [1.0, f64::NAN, f64::INFINITY, 2.0].into_iter().enumerate() {
            let place = || format!("line {at}");
            series.push(at as i64, value, place).unwrap();
        }
        series.push(3, 5.0, String::new).unwrap();
        series.drop_repeated();
        assert_eq!((series.times.as_slice(), series.repeated), (&[0, 3][..], 1));
        assert!((series.values[1] - 2e-3).abs() < 1e-12);
        assert_eq!(
            (series.missing, series.first_missing.as_deref()),
            (2, Some("line 1"))
        );
        assert!(series.push(2, 1.0, String::new).is_err());
    }
}
