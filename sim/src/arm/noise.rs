//! Seeded normally distributed numbers.

use rand_pcg::Pcg64;
use rand_pcg::rand_core::{RngCore, SeedableRng};

/// A stream of standard normal numbers; the same seed gives the same stream.
#[derive(Clone, Debug)]
pub(crate) struct Noise {
    generator: Pcg64,
    spare: Option<f64>,
}

impl Noise {
    pub(crate) fn new(seed: u64) -> Self {
        Self {
            generator: Pcg64::seed_from_u64(seed),
            spare: None,
        }
    }

    /// Uniform in −1 … 1.
    fn uniform(&mut self) -> f64 {
        // The upper 53 bits fill the mantissa.
        (self.generator.next_u64() >> 11) as f64 * (2.0 / (1u64 << 53) as f64) - 1.0
    }

    /// Normally distributed with mean 0 and standard deviation `deviation`,
    /// by Marsaglia's polar method.
    pub(crate) fn normal(&mut self, deviation: f64) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare * deviation;
        }
        loop {
            let (x, y) = (self.uniform(), self.uniform());
            let square = x * x + y * y;
            if square > 0.0 && square < 1.0 {
                let scale = (-2.0 * square.ln() / square).sqrt();
                self.spare = Some(y * scale);
                return x * scale * deviation;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_those_of_the_normal_distribution() {
        let mut noise = Noise::new(7);
        let count = 100_000;
        let (mut first, mut second, mut fourth) = (0.0, 0.0, 0.0);
        for _ in 0..count {
            let x = noise.normal(2.0);
            first += x;
            second += x * x;
            fourth += x.powi(4);
        }
        let n = f64::from(count);
        assert!((first / n).abs() < 0.03);
        assert!((second / n - 4.0).abs() < 0.08);
        assert!((fourth / n - 48.0).abs() < 3.0);
    }
}
