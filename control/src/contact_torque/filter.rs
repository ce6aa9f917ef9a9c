//! Causal low-pass that gives the signal and its first two derivatives.
//!
//! A Butterworth filter of third order, with the state x, ẋ, ẍ:
//!
//! d³x/dt³ = ω³ (u − x) − 2 ω² ẋ − 2 ω ẍ,
//!
//! integrated by the trapezoidal rule, which is stable at any step. Signal
//! and derivatives have the same delay of about 2/ω, and channels that are
//! filtered alike stay consistent with one another.

use std::f64::consts::TAU;

/// The filter, one channel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DerivativeFilter {
    omega: f64,
    input: f64,
    value: f64,
    first: f64,
    second: f64,
}

impl DerivativeFilter {
    /// A filter with `cut_off` \[Hz\] (−3 dB), at rest at zero.
    pub fn new(cut_off: f64) -> Self {
        Self {
            omega: TAU * cut_off,
            ..Self::default()
        }
    }

    /// Starts again, at rest at `input`.
    pub fn reset(&mut self, input: f64) {
        *self = Self {
            omega: self.omega,
            input,
            value: input,
            first: 0.0,
            second: 0.0,
        };
    }

    /// Takes in `input`, `dt` \[s\] after the last one.
    pub fn step(&mut self, input: f64, dt: f64) {
        let (h, w) = (0.5 * dt, self.omega);
        let (w2, w3) = (2.0 * w * w, w * w * w);
        let jerk = w3 * (self.input - self.value) - w2 * self.first - 2.0 * w * self.second;
        // First and value at the end, less what the second derivative there adds.
        let first = self.first + h * self.second;
        let value = self.value + h * (self.first + first);
        let right = self.second + h * (jerk + w3 * (input - value) - w2 * first);
        let second = right / (1.0 + h * (2.0 * w + h * (w2 + h * w3)));
        self.second = second;
        self.first = first + h * second;
        self.value = value + h * h * second;
        self.input = input;
    }

    /// How late signal and derivatives are \[s\], for slow signals: 2/ω.
    pub fn delay(&self) -> f64 {
        2.0 / self.omega
    }

    /// The filtered signal.
    pub fn value(&self) -> f64 {
        self.value
    }

    /// Its first derivative \[1/s\].
    pub fn first(&self) -> f64 {
        self.first
    }

    /// Its second derivative \[1/s²\].
    pub fn second(&self) -> f64 {
        self.second
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const CUT_OFF: f64 = 40.0;

    /// Gain and phase at `frequency` \[Hz\], by projection on sine and cosine.
    fn response(frequency: f64) -> (f64, f64) {
        let mut filter = DerivativeFilter::new(CUT_OFF);
        let (dt, mut sine, mut cosine) = (1e-4, 0.0, 0.0);
        let count = (20.0 / frequency / dt).round() as i32;
        for k in 1..=2 * count {
            let phase = TAU * frequency * dt * f64::from(k);
            filter.step(phase.sin(), dt);
            if k > count {
                sine += filter.value() * phase.sin() * 2.0 / f64::from(count);
                cosine += filter.value() * phase.cos() * 2.0 / f64::from(count);
            }
        }
        (sine.hypot(cosine), cosine.atan2(sine))
    }

    #[test]
    fn it_is_a_butterworth_filter_of_third_order() {
        for ratio in [0.25_f64, 0.5, 1.0, 2.0] {
            let (gain, _) = response(CUT_OFF * ratio);
            let butterworth = 1.0 / (1.0 + ratio.powi(6)).sqrt();
            assert!((gain - butterworth).abs() < 2e-3, "{ratio}: {gain}");
        }
        let (_, phase) = response(2.0);
        let delay = -phase / (TAU * 2.0);
        assert!((delay - 2.0 / (TAU * CUT_OFF)).abs() < 1e-4, "{delay}");
    }

    #[test]
    fn derivatives_are_those_of_the_signal() {
        let mut filter = DerivativeFilter::new(CUT_OFF);
        for k in 0..=1000 {
            let t = f64::from(k) * 1e-3;
            filter.step(1.0 + 2.0 * t + 1.5 * t * t, 1e-3);
        }
        // A parabola, seen 2/ω late.
        let late = 1.0 - 2.0 / (TAU * CUT_OFF);
        assert!((filter.second() - 3.0).abs() < 1e-6);
        assert!((filter.first() - (2.0 + 3.0 * late)).abs() < 1e-5);
    }

    proptest! {
        #[test]
        fn no_step_size_makes_it_diverge(dt in 1e-6..10.0f64, input in -1e3..1e3f64) {
            let mut filter = DerivativeFilter::new(CUT_OFF);
            for _ in 0..200 {
                filter.step(input, dt);
            }
            prop_assert!(filter.value().abs() <= 3.0 * input.abs());
        }
    }
}
