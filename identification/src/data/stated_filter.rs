//! The filters of a published identification, to reproduce it.
//!
//! Gautier's inverse-dynamics procedure, as Janot, Gautier and Brunot 2019 use
//! it on the EMPS: position through a Butterworth low-pass forwards and
//! backwards, velocity and acceleration by central differences, every column
//! and the torque through the Chebyshev low-pass of a decimation, forwards and
//! backwards; no row is left out for its speed, unless a least speed is stated.
//!
//! A filter run forwards and backwards has no phase: it is a symmetric finite
//! impulse response with the square of the filter's gain, known in closed form
//! after the bilinear transformation.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use crate::numerics::filter::Kernel;

/// Order of the Butterworth filter.
const BUTTERWORTH_ORDER: i32 = 4;
/// Order of the decimation's Chebyshev filter (first kind), its ripple \[dB\], and
/// its edge as a share of half the new rate.
const CHEBYSHEV_ORDER: f64 = 8.0;
const CHEBYSHEV_RIPPLE: f64 = 0.05;
const CHEBYSHEV_EDGE: f64 = 0.8;
/// Share of the filters' weights that may lie beyond what they are said to look at.
const BEYOND: f64 = 1e-3;
/// Points on the unit circle at which a gain is taken.
const POINTS: usize = 8192;

/// Filters stated in place of those that are chosen from the noise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StatedFilter {
    /// Cut-off (−3 dB, one way) of the Butterworth filter on the position \[Hz\].
    pub butterworth_hz: f64,
    /// Every so many samples give a row.
    pub decimation: usize,
    /// Slower rows \[rad/s, of a prismatic joint m/s\] are left out: friction near
    /// rest has no value of its own.
    #[serde(default)]
    pub least_speed: f64,
}

impl StatedFilter {
    /// Filters of position, velocity and acceleration for samples `period` \[s\] apart.
    #[must_use]
    pub fn states(&self, period: f64) -> [Kernel; 3] {
        let edge = (PI * self.butterworth_hz * period).min(0.499 * PI).tan();
        let gain = |angle: f64| {
            let ratio = (0.5 * angle).tan() / edge;
            1.0 / (1.0 + ratio.powi(2 * BUTTERWORTH_ORDER))
        };
        // After half a dozen periods of the cut-off nothing is left.
        let half = (6.0 / (self.butterworth_hz * period)).ceil() as usize;
        let position = taps(gain, half.clamp(4, POINTS / 4));
        let velocity = central_difference(&position, period);
        let acceleration = central_difference(&velocity, period);
        [position, velocity, acceleration].map(Kernel::with_taps)
    }

    /// Filter of every column and of the torque.
    #[must_use]
    pub fn column(&self) -> Kernel {
        let every = self.decimation.max(1) as f64;
        if self.decimation <= 1 {
            return Kernel::with_taps(vec![1.0]);
        }
        let edge = (0.5 * PI * CHEBYSHEV_EDGE / every).tan();
        let ripple = 10_f64.powf(0.1 * CHEBYSHEV_RIPPLE) - 1.0;
        let gain = |angle: f64| {
            let ratio = (0.5 * angle).tan() / edge;
            let polynomial = match ratio <= 1.0 {
                true => (CHEBYSHEV_ORDER * ratio.acos()).cos(),
                false => (CHEBYSHEV_ORDER * ratio.acosh()).cosh(),
            };
            1.0 / (1.0 + ripple * polynomial * polynomial)
        };
        Kernel::with_taps(taps(gain, ((60.0 * every) as usize).min(POINTS / 4)))
    }

    /// Samples on either side that the filter of columns looks at.
    #[must_use]
    pub(crate) fn column_reach(&self) -> usize {
        self.column().reach_but_for(BEYOND)
    }

    /// The same of both filters, one after the other: of `state` and of the `column`.
    #[must_use]
    pub(crate) fn reach(state: &Kernel, column: &Kernel) -> usize {
        state.sizes_with(column).reach_but_for(BEYOND)
    }

    /// Samples that are rows, of so many, however slow: all but those within `reach` of an end,
    /// beyond which the filters would look.
    #[must_use]
    pub fn rows(&self, samples: usize, reach: usize) -> Vec<usize> {
        let last = samples.saturating_sub(reach);
        (reach..last).step_by(self.decimation.max(1)).collect()
    }

    /// Whether a row of this `velocity` \[rad/s\] is left out.
    #[must_use]
    pub fn is_slow(&self, velocity: f64) -> bool {
        velocity.abs() < self.least_speed
    }

    /// The same filters at `factor` times the cut-off.
    #[must_use]
    pub fn at_cut_off(&self, factor: f64) -> Self {
        Self {
            butterworth_hz: self.butterworth_hz * factor,
            decimation: ((self.decimation.max(1) as f64 / factor).round() as usize).max(1),
            ..*self
        }
    }
}

/// Impulse response from −`half` to `half` of the zero-phase filter whose gain,
/// squared as for one pass each way, is `gain` of the angle 0 … π.
fn taps(gain: impl Fn(f64) -> f64, half: usize) -> Vec<f64> {
    let gains: Vec<f64> = (0..POINTS / 2)
        .map(|k| gain(2.0 * PI * k as f64 / POINTS as f64))
        .collect();
    let cosines: Vec<f64> = (0..POINTS)
        .map(|k| (2.0 * PI * k as f64 / POINTS as f64).cos())
        .collect();
    let one_side: Vec<f64> = (0..=half)
        .map(|n| {
            let sum: f64 = gains
                .iter()
                .enumerate()
                .skip(1)
                .map(|(k, gain)| gain * cosines[n * k % POINTS])
                .sum();
            (gains[0] + 2.0 * sum) / POINTS as f64
        })
        .collect();
    let all: Vec<f64> = one_side
        .iter()
        .skip(1)
        .rev()
        .chain(&one_side)
        .copied()
        .collect();
    // What was cut off is made up for, so that constants pass unchanged.
    let sum: f64 = all.iter().sum();
    all.iter().map(|tap| tap / sum).collect()
}

/// The filter, then (x₍ₖ₊₁₎ − x₍ₖ₋₁₎) / 2h.
fn central_difference(taps: &[f64], period: f64) -> Vec<f64> {
    let at = |index: Option<usize>| index.and_then(|i| taps.get(i)).copied().unwrap_or(0.0);
    (0..taps.len() + 2)
        .map(|i| (at(i.checked_sub(2)) - at(Some(i))) / (2.0 * period))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILTER: StatedFilter = StatedFilter {
        butterworth_hz: 100.0,
        decimation: 10,
        least_speed: 0.0,
    };

    /// Gain of a symmetric kernel at `hertz`, sampled at 1 kHz.
    fn gain(kernel: &Kernel, hertz: f64) -> f64 {
        let signal: Vec<f64> = (0..4001)
            .map(|i| (2.0 * PI * hertz * f64::from(i - 2000) * 1e-3).cos())
            .collect();
        kernel.at(&signal, 2000)
    }

    #[test]
    fn gains_are_those_of_the_filters_run_both_ways() {
        let [position, ..] = FILTER.states(1e-3);
        // One way the cut-off is −3 dB, so both ways a half.
        assert!((gain(&position, 100.0) - 0.5).abs() < 1e-3);
        assert!((gain(&position, 10.0) - 1.0).abs() < 1e-6);
        assert!(gain(&position, 250.0) < 1e-3);
        let column = FILTER.column();
        // Ripples of 0.05 dB each way; at the edge as low as at rest, which is
        // set to 1; then steeply down.
        assert!((gain(&column, 40.0) - 1.0).abs() < 2e-3);
        assert!((gain(&column, 5.0) - 1.0).abs() < 0.013);
        assert!(gain(&column, 50.0) < 0.05 && gain(&column, 100.0).abs() < 1e-4);
    }

    #[test]
    fn differences_are_exact_for_lines_and_parabolas() {
        let [_, velocity, acceleration] = FILTER.states(1e-3);
        let signal: Vec<f64> = (0..1001)
            .map(|i| f64::from(i) * 1e-3)
            .map(|t| 1.0 + 2.0 * t + 3.0 * t * t)
            .collect();
        assert!((velocity.at(&signal, 500) - 5.0).abs() < 1e-6);
        assert!((acceleration.at(&signal, 500) - 6.0).abs() < 1e-3);
    }

    #[test]
    fn rows_are_every_tenth_sample_away_from_the_ends() {
        let all: Vec<usize> = (100..900).step_by(10).collect();
        assert_eq!(FILTER.rows(1000, 100), all);
        assert_eq!(FILTER.rows(150, 100), [] as [usize; 0]);
    }

    /// A pole s of the filter leaves exp(s t) behind: of this Chebyshev filter the slowest decays
    /// at 0.073 of its edge of 40 Hz, 18.3 /s, and has fallen to a thousandth after 0.38 s; of a
    /// Butterworth filter of 5 Hz at sin(π/8) of it, 12.0 /s, after 0.57 s.
    #[test]
    fn filters_reach_as_far_as_their_slowest_poles() {
        let reach = FILTER.column_reach();
        assert!((300..400).contains(&reach), "{reach}");
        let slow = StatedFilter {
            butterworth_hz: 5.0,
            ..FILTER
        };
        let column = slow.column();
        for state in slow.states(1e-3) {
            let reach = StatedFilter::reach(&state, &column);
            assert!((500..700).contains(&reach), "{reach}");
        }
        let plain = StatedFilter {
            decimation: 1,
            ..FILTER
        };
        assert_eq!(plain.column_reach(), 0);
    }

    #[test]
    fn slow_rows_are_left_out_in_both_directions() {
        let filter = StatedFilter {
            least_speed: 0.2,
            ..FILTER
        };
        assert!(filter.is_slow(0.1) && filter.is_slow(-0.19) && !filter.is_slow(-0.3));
        assert!(!FILTER.is_slow(0.0));
    }

    #[test]
    fn twice_the_cut_off_takes_every_fifth_sample() {
        let filter = FILTER.at_cut_off(2.0);
        assert_eq!((filter.butterworth_hz, filter.decimation), (200.0, 5));
        let none = StatedFilter {
            decimation: 0,
            ..FILTER
        };
        assert_eq!(none.at_cut_off(4.0).decimation, 1);
    }
}
