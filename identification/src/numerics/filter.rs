//! Zero-phase smoothing and differentiation.
//!
//! A Gaussian and its derivatives as finite impulse responses: symmetric, so
//! without phase; short, so without memory of a session's start; and the
//! derivative of the smoothed signal is exactly the smoothed signal's
//! derivative, which makes position, velocity, acceleration and torques
//! consistent with each other.

use nalgebra::{DMatrix, DVector};

use super::gram::dot;
use super::statistics::quantile_or_zero;

/// A finite impulse response, centred.
#[derive(Clone, Debug)]
pub struct Kernel {
    taps: Vec<f64>,
}

impl Kernel {
    /// Gaussian of standard deviation `sigma` \[samples\] (> 0), differentiated
    /// `order` times (0, 1 or 2) for samples `period` \[s\] apart.
    ///
    /// Moments are set right for the sampled taps: constants pass order 0
    /// unchanged, straight lines give their exact slope by order 1, parabolas
    /// their exact curvature by order 2.
    #[must_use]
    pub fn gaussian(sigma: f64, order: u8, period: f64) -> Self {
        let radius = Self::reach(sigma) as i64;
        let position = |i: usize| i as f64 - radius as f64;
        let mut gauss: Vec<f64> = (0..=2 * radius as usize)
            .map(|i| (-0.5 * (position(i) / sigma).powi(2)).exp())
            .collect();
        let sum: f64 = gauss.iter().sum();
        gauss.iter_mut().for_each(|g| *g /= sum);
        let moment = |n: i32| -> f64 {
            gauss
                .iter()
                .enumerate()
                .map(|(i, g)| g * position(i).powi(n))
                .sum()
        };
        let (second, fourth) = (moment(2), moment(4));
        let taps = gauss
            .iter()
            .enumerate()
            .map(|(i, g)| match order {
                0 => *g,
                1 => g * position(i) / second / period,
                _ => {
                    2.0 * g * (position(i).powi(2) - second)
                        / (fourth - second * second)
                        / (period * period)
                }
            })
            .collect();
        Self { taps }
    }

    /// As [`Self::gaussian`], yet exact for polynomials two degrees higher: a
    /// Gaussian flattens peaks, and steep friction at the wrong velocity is a
    /// large error. It lets more noise through.
    #[must_use]
    pub fn sharp(sigma: f64, order: u8, period: f64) -> Self {
        let radius = Self::reach(sigma).max(2) as i64;
        let places: Vec<f64> = (-radius..=radius).map(|i| i as f64).collect();
        let gauss: Vec<f64> = places
            .iter()
            .map(|x| (-0.5 * (x / sigma).powi(2)).exp())
            .collect();
        // taps = Gaussian × (c₀ + c₁ x² …) x^parity, such that the moments of
        // degree `order` and its neighbours are those of the derivative.
        let parity = i32::from(order % 2);
        let degrees: Vec<i32> = if order == 2 {
            vec![0, 2, 4]
        } else {
            vec![parity, parity + 2]
        };
        let n = degrees.len();
        let system = DMatrix::from_fn(n, n, |row, column| {
            places
                .iter()
                .zip(&gauss)
                .map(|(x, g)| g * x.powi(degrees[row] + degrees[column]))
                .sum()
        });
        let factorial = if order == 2 { 2.0 } else { 1.0 };
        let wanted = DVector::from_fn(n, |row, _| {
            if degrees[row] == i32::from(order) {
                factorial
            } else {
                0.0
            }
        });
        let Some(c) = system.lu().solve(&wanted) else {
            return Self::gaussian(sigma, order, period);
        };
        let scale = period.powi(-i32::from(order));
        let taps = places
            .iter()
            .zip(&gauss)
            .map(|(x, g)| {
                scale
                    * g
                    * degrees
                        .iter()
                        .zip(c.iter())
                        .map(|(d, c)| c * x.powi(*d))
                        .sum::<f64>()
            })
            .collect();
        Self { taps }
    }

    /// With these weights, the middle one for the sample itself.
    #[must_use]
    pub(crate) fn with_taps(taps: Vec<f64>) -> Self {
        Self { taps }
    }

    /// Its weights, around the sample in their middle.
    pub(crate) fn taps(&self) -> &[f64] {
        &self.taps
    }

    /// Samples on either side that a Gaussian of `sigma` \[samples\] looks at.
    #[must_use]
    pub fn reach(sigma: f64) -> usize {
        ((3.5 * sigma).ceil() as usize).max(1)
    }

    /// Samples on either side beyond which less than `share` of the weights lies, by their size.
    #[must_use]
    pub(crate) fn reach_but_for(&self, share: f64) -> usize {
        let radius = self.taps.len() / 2;
        let size = |at: usize| self.taps.get(at).map_or(0.0, |tap| tap.abs());
        let all: f64 = self.taps.iter().map(|tap| tap.abs()).sum();
        let mut beyond = 0.0;
        for reach in (0..=radius).rev() {
            // What this distance weighs on both sides, once it is left out, too.
            beyond += size(radius - reach) + if reach > 0 { size(radius + reach) } else { 0.0 };
            if beyond >= share * all {
                return reach;
            }
        }
        0
    }

    /// How much each sample may weigh after this kernel and then `next`: the sizes of the weights,
    /// as what lies between both need not be linear.
    #[must_use]
    pub(crate) fn sizes_with(&self, next: &Self) -> Self {
        let count = (self.taps.len() + next.taps.len()).saturating_sub(1);
        let mut taps = vec![0.0; count];
        for (at, own) in self.taps.iter().enumerate() {
            let sums = taps.iter_mut().skip(at).zip(&next.taps);
            sums.for_each(|(sum, tap)| *sum += (own * tap).abs());
        }
        Self { taps }
    }

    /// Variance of the output for white noise of unit variance.
    #[must_use]
    pub fn noise_gain(&self) -> f64 {
        self.taps.iter().map(|t| t * t).sum()
    }

    /// Frequency \[Hz\] above which less than half of the power passes (−3 dB), for
    /// samples `period` \[s\] apart; half the sampling rate where all of it passes.
    #[must_use]
    pub fn cut_off(&self, period: f64) -> f64 {
        const STEPS: usize = 20_000;
        let radius = (self.taps.len() / 2) as f64;
        let gain = |step: usize| -> f64 {
            let angle = std::f64::consts::PI * step as f64 / STEPS as f64;
            let each = self.taps.iter().enumerate();
            each.map(|(i, tap)| tap * (angle * (i as f64 - radius)).cos())
                .sum()
        };
        let passes = |step: usize| gain(step).abs() >= std::f64::consts::FRAC_1_SQRT_2;
        // Coarse steps first, then those between.
        let coarse = (0..=STEPS).step_by(100).find(|step| !passes(*step));
        let first = coarse.map_or(STEPS, |end| {
            let between = end.saturating_sub(100)..end;
            between
                .into_iter()
                .find(|step| !passes(*step))
                .unwrap_or(end)
        });
        first as f64 / STEPS as f64 * 0.5 / period
    }

    /// Value at sample `at`; beyond the ends the signal keeps its end value.
    #[must_use]
    pub fn at(&self, signal: &[f64], at: usize) -> f64 {
        let radius = self.taps.len() / 2;
        if at >= radius
            && let Some(window) = signal.get(at - radius..at + radius + 1)
        {
            return dot(&self.taps, window);
        }
        let last = signal.len().saturating_sub(1);
        self.taps
            .iter()
            .enumerate()
            .map(|(i, t)| {
                let index = (at + i).saturating_sub(radius).min(last);
                t * signal.get(index).copied().unwrap_or(0.0)
            })
            .sum()
    }

    /// Value at every sample.
    #[must_use]
    pub fn everywhere(&self, signal: &[f64]) -> Vec<f64> {
        /// Samples side by side, all of which take a tap at once.
        const SIDE: usize = 8;
        let radius = self.taps.len() / 2;
        let mut values = Vec::with_capacity(signal.len());
        let first = 0..radius.min(signal.len());
        values.extend(first.map(|at| self.at(signal, at)));
        let windows = signal.windows(self.taps.len() + SIDE - 1);
        for window in windows.step_by(SIDE) {
            let mut sums = [0.0; SIDE];
            for (tap, samples) in self.taps.iter().zip(window.windows(SIDE)) {
                for lane in 0..SIDE {
                    sums[lane] += tap * samples[lane];
                }
            }
            values.extend(sums);
        }
        let rest = values.len()..signal.len();
        values.extend(rest.map(|at| self.at(signal, at)));
        values
    }

    /// Value at some samples.
    #[must_use]
    pub fn at_samples(&self, signal: &[f64], samples: &[usize]) -> Vec<f64> {
        samples.iter().map(|at| self.at(signal, *at)).collect()
    }
}

/// Standard deviation of the noise in a smooth signal: its fourth differences
/// hold next to nothing else. The median keeps single jumps out.
#[must_use]
pub fn noise_level(signal: &[f64]) -> f64 {
    let mut differences: Vec<f64> = signal
        .windows(5)
        .map(|w| (w[0] - 4.0 * w[1] + 6.0 * w[2] - 4.0 * w[3] + w[4]).abs())
        .collect();
    if differences.is_empty() {
        return 0.0;
    }
    let rms = (differences.iter().map(|d| d * d).sum::<f64>() / differences.len() as f64).sqrt();
    let median = quantile_or_zero(&mut differences, 0.5);
    // A coarse encoder stands still most of the time: its median is zero then,
    // and the root mean square is the better estimate.
    let level = if median > 0.2 * rms {
        median / 0.6745
    } else {
        rms
    };
    level / 70.0_f64.sqrt()
}

/// Widths \[samples\] of smoothing to choose from.
const WIDTHS: [f64; 6] = [1.0, 1.5, 2.0, 3.0, 4.0, 6.0];
/// Largest share of noise in a smoothed derivative.
const MAX_NOISE_SHARE: f64 = 0.05;

/// The least width \[samples\] of [`Kernel::sharp`] that leaves the derivative of
/// this `order` a twentieth noise; the greatest where none does.
#[must_use]
pub fn least_width(signals: &[Vec<f64>], order: u8, period: f64) -> f64 {
    let [.., greatest] = WIDTHS;
    quiet_width(signals, order, period).unwrap_or(greatest)
}

/// The same; `None` where the greatest leaves more noise, too.
#[must_use]
pub fn quiet_width(signals: &[Vec<f64>], order: u8, period: f64) -> Option<f64> {
    let noise = signals.iter().map(|s| noise_level(s)).fold(0.0, f64::max);
    let is_quiet = |width: f64| {
        let kernel = Kernel::sharp(width, order, period);
        let (mut sum, mut count) = (0.0, 1e-9);
        for signal in signals {
            for at in (0..signal.len()).step_by(3) {
                sum += kernel.at(signal, at).powi(2);
                count += 1.0;
            }
        }
        noise * noise * kernel.noise_gain() < MAX_NOISE_SHARE * MAX_NOISE_SHARE * sum / count
    };
    WIDTHS.into_iter().find(|width| is_quiet(*width))
}

/// Thins a signal by `factor` after a Gaussian against aliasing.
#[must_use]
pub fn thin(signal: &[f64], factor: usize) -> Vec<f64> {
    if factor <= 1 {
        return signal.to_vec();
    }
    let kernel = Kernel::gaussian(0.5 * factor as f64, 0, 1.0);
    (0..signal.len())
        .step_by(factor)
        .map(|at| kernel.at(signal, at))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::recordings::noise;

    #[test]
    fn polynomials_are_differentiated_exactly() {
        let period = 0.012;
        let signal: Vec<f64> = (0..60)
            .map(|i| i as f64 * period)
            .map(|t| 3.0 + 2.0 * t - 5.0 * t * t)
            .collect();
        let t = 30.0 * period;
        for sigma in [0.8, 1.5, 3.0] {
            let value = |order| Kernel::gaussian(sigma, order, period).at(&signal, 30);
            assert!((value(1) - (2.0 - 10.0 * t)).abs() < 1e-9);
            assert!((value(2) + 10.0).abs() < 1e-6);
        }
    }

    #[test]
    fn sharp_kernels_are_exact_two_degrees_further() {
        let period = 0.01;
        let value = |t: f64| 1.0 - t + 2.0 * t * t - 3.0 * t.powi(3);
        let signal: Vec<f64> = (0..60).map(|i| value(f64::from(i) * period)).collect();
        let t: f64 = 0.3;
        for sigma in [0.8, 1.0, 2.0] {
            let at = |order| Kernel::sharp(sigma, order, period).at(&signal, 30);
            assert!((at(0) - value(t)).abs() < 1e-9);
            assert!((at(1) - (-1.0 + 4.0 * t - 9.0 * t * t)).abs() < 1e-8);
            assert!((at(2) - (4.0 - 18.0 * t)).abs() < 1e-6);
        }
    }

    #[test]
    fn no_phase_between_a_sine_and_its_smoothed_self() {
        let signal: Vec<f64> = (0..400).map(|i| (0.1 * f64::from(i)).sin()).collect();
        let smooth = Kernel::gaussian(2.0, 0, 1.0).everywhere(&signal);
        // The Gaussian's own transfer function: exp(−(ωσ)²/2).
        let gain = (-0.5_f64 * 0.04).exp();
        for at in 20..380 {
            assert!((smooth[at] - gain * signal[at]).abs() < 2e-3);
        }
    }

    /// A Gaussian of standard deviation σ passes exp(−(2π f σ)²/2): half of the power
    /// at f = √(ln 2)/(2π σ).
    #[test]
    fn half_of_the_power_passes_at_the_cut_off() {
        for sigma in [2.0, 3.0, 6.0] {
            let expected = 2.0_f64.ln().sqrt() / (std::f64::consts::TAU * sigma * 0.002);
            let found = Kernel::gaussian(sigma, 0, 0.002).cut_off(0.002);
            assert!((found / expected - 1.0).abs() < 0.01, "{found} {expected}");
        }
        assert_eq!(Kernel::with_taps(vec![1.0]).cut_off(0.001), 500.0);
    }

    #[test]
    fn what_lies_beyond_the_reach_weighs_less_than_its_share() {
        let kernel = Kernel::with_taps(vec![-0.01, 0.1, -0.2, 1.0, -0.2, 0.1, -0.01]);
        // Sizes 1.62 in all: 0.02 lie beyond two samples, 0.22 beyond one, 0.62 beyond none.
        for (share, reach) in [(0.01, 3), (0.02, 2), (0.13, 2), (0.14, 1), (0.39, 0)] {
            assert_eq!(kernel.reach_but_for(share), reach, "{share}");
        }
        assert_eq!(Kernel::with_taps(vec![1.0]).reach_but_for(1e-3), 0);
        // Two normal distributions one after the other are one of the sum of both variances.
        let [a, b, both] = [3.0, 4.0, 5.0].map(|sigma| Kernel::gaussian(sigma, 0, 1.0));
        let found = a.sizes_with(&b);
        assert_eq!(found.taps().len(), a.taps().len() + b.taps().len() - 1);
        let (found, expected) = (found.reach_but_for(0.01), both.reach_but_for(0.01));
        // 1 % lie beyond 2.576 standard deviations.
        assert!(
            found.abs_diff(13) <= 1 && expected.abs_diff(13) <= 1,
            "{found} {expected}"
        );
    }

    #[test]
    fn noise_is_separated_from_motion() {
        let mut noise = noise(1);
        let signal: Vec<f64> = (0..4000)
            .map(|i| (0.01 * f64::from(i)).sin() + 1e-3 * noise())
            .collect();
        let level = noise_level(&signal);
        assert!(level > 0.9e-3 && level < 1.1e-3, "{level}");
    }
}
