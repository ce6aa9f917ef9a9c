//! How often readings come, how evenly, and how late. Pure.

use ferntast_identification::numerics::statistics::quantile;
use serde::Serialize;

use super::{
    expected::Expected,
    finding::{Finding, Severity},
    record::Record,
};

/// From readings further apart the servo begins anew each time \[s\].
const BEGINS_ANEW: f64 = 0.010;
/// The estimator's filter asks for so many readings a second \[Hz\].
const LEAST_RATE: f64 = 100.0;

/// Times of the readings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Timing {
    /// Readings a second \[Hz\].
    pub rate_hz: f64,
    /// From one to the next, 99th percentile \[ms\].
    pub gap_p99_ms: Option<f64>,
    /// The longest \[ms\].
    pub longest_gap_ms: Option<f64>,
    /// From one stamp to the next, 99th percentile less median \[ms\]; `null` without stamps.
    pub stamp_jitter_ms: Option<f64>,
    /// How much older than the youngest a reading is when it comes, 99th percentile \[ms\].
    pub delay_p99_ms: Option<f64>,
}

impl Timing {
    /// Of what was seen.
    pub fn of(record: &Record) -> Timing {
        let times: Vec<f64> = record.seen.iter().map(|own| own.at).collect();
        let mut gaps: Vec<f64> = times.windows(2).map(|own| own[1] - own[0]).collect();
        let longest = gaps.iter().copied().reduce(f64::max);
        let stamps: Vec<f64> = record.seen.iter().filter_map(|own| own.stamp).collect();
        let mut intervals: Vec<f64> = stamps.windows(2).map(|own| own[1] - own[0]).collect();
        let delays = record.seen.iter().filter_map(|own| own.delay);
        let least = delays.clone().reduce(f64::min).unwrap_or(0.0);
        let mut delays: Vec<f64> = delays.map(|own| own - least).collect();
        let ms = |seconds: f64| seconds * 1e3;
        let share = |values: &mut Vec<f64>, share| quantile(values, share, f64::total_cmp);
        let middle = share(&mut intervals, 0.5);
        Timing {
            rate_hz: match record.seconds > 0.0 {
                true => times.len() as f64 / record.seconds,
                false => 0.0,
            },
            gap_p99_ms: share(&mut gaps, 0.99).map(ms),
            longest_gap_ms: longest.map(ms),
            stamp_jitter_ms: share(&mut intervals, 0.99)
                .zip(middle)
                .map(|(most, middle)| ms(most - middle)),
            delay_p99_ms: share(&mut delays, 0.99).map(ms),
        }
    }

    pub(super) fn judge(&self, expected: &Expected, findings: &mut Vec<Finding>) {
        let mut find = |severity, what, words: String| {
            findings.push(Finding::new(severity, what, words));
        };
        let rate = self.rate_hz;
        if rate < LEAST_RATE {
            find(
                Severity::Wrong,
                "rate",
                format!(
                    "{rate:.0} readings a second; the servo needs {LEAST_RATE:.0}: raise the rate of the arm's own driver"
                ),
            );
        }
        let limit = expected.longest_gap * 1e3;
        match (self.longest_gap_ms, self.gap_p99_ms) {
            (Some(gap), _) if gap > limit => find(
                Severity::Wrong,
                "gap",
                format!(
                    "{gap:.0} ms without a reading; after {limit:.0} ms the servo takes that as a fault"
                ),
            ),
            (_, Some(gap)) if gap > BEGINS_ANEW * 1e3 => find(
                Severity::Doubtful,
                "jitter",
                format!(
                    "one reading in a hundred comes more than {gap:.1} ms after the one before: an uneven way, or a busy computer"
                ),
            ),
            _ => {}
        }
        if let Some(delay) = self.delay_p99_ms.filter(|&own| own > limit) {
            find(
                Severity::Doubtful,
                "age",
                format!(
                    "one reading in a hundred is {delay:.0} ms older than the youngest when it comes"
                ),
            );
        }
        if let Some(jitter) = self.stamp_jitter_ms.filter(|&own| own > limit) {
            find(
                Severity::Doubtful,
                "stamps",
                format!(
                    "stamps are up to {jitter:.0} ms further apart than usual: is the arm's own loop held up?"
                ),
            );
        }
    }
}
