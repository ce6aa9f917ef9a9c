//! A value that changes evenly, followed without lag.

/// Smoothed without lag while it changes evenly (as the tracker of the servo).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Even {
    /// The value.
    pub value: f64,
    /// Its rate [1/s].
    pub rate: f64,
}

impl Even {
    /// At rest.
    pub fn at(value: f64) -> Even {
        Even { value, rate: 0.0 }
    }

    /// After `dt` \[s\], with natural frequency `frequency` \[rad/s\]. Gives what of `value`
    /// is not even.
    pub fn step(&mut self, dt: f64, frequency: f64, value: f64) -> f64 {
        let error = value - self.value;
        self.rate += frequency * frequency * error * dt;
        self.value += (self.rate + 2.0 * frequency * error) * dt;
        error
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EVEN: f64 = 25.0;

    #[test]
    fn what_changes_evenly_is_followed_without_lag_and_what_does_not_is_left() {
        let mut even = Even::at(0.0);
        let rate = 0.02;
        let mut left = 1.0;
        for k in 1..=1000 {
            left = even.step(1e-3, EVEN, rate * 1e-3 * f64::from(k));
        }
        assert!(f64::abs(left) < 1e-3 * rate / EVEN, "{left}");
        assert!((even.rate / rate - 1.0).abs() < 1e-3, "{even:?}");
        let left = even.step(1e-3, EVEN, even.value + 0.01);
        assert!((left - 0.01).abs() < 1e-9, "{left}");
    }
}
