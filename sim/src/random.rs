//! Seeded random numbers for channel and hand.

use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{RngCore, SeedableRng};

/// Same seed, same numbers.
#[derive(Clone, Debug)]
pub(crate) struct Random {
    generator: Pcg64Mcg,
}

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Random {
            generator: Pcg64Mcg::seed_from_u64(seed),
        }
    }

    /// Uniform on [0, 1).
    pub(crate) fn uniform(&mut self) -> f64 {
        (self.generator.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }

    /// True with `probability`.
    pub(crate) fn chance(&mut self, probability: f64) -> bool {
        self.uniform() < probability
    }

    /// Standard normal, by Box and Muller; one of the pair is thrown away so
    /// that every draw takes the same numbers from the stream.
    pub(crate) fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }

    /// Exponential with mean 1.
    pub(crate) fn exponential(&mut self) -> f64 {
        -(1.0 - self.uniform()).ln()
    }
}
