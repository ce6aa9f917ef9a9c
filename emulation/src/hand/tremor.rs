//! Physiological tremor: the trembling of a healthy hand, 8 to 12 Hz (Elble and
//! Koller 1990, *Tremor*; Riviere, Rader, Khosla 1997 found about 50 µm).

use crate::random::Random;
use ferntast_model::parameters;

parameters! {
    /// How a hand trembles.
    #[derive(Copy)]
    pub struct TremorParameters {
        /// Root mean square along each axis \[m\].
        pub amplitude: f64 [0.0..=0.01, "m"],
    }
}

const PARTIALS: usize = 4;
const BAND: [f64; 2] = [8.0, 12.0];

#[derive(Clone, Copy, Debug, Default)]
struct Partial {
    /// [rad/s]
    frequency: f64,
    phase: f64,
}

/// A sum of sines with frequencies and phases drawn from the seed.
#[derive(Clone, Copy, Debug)]
pub struct Tremor {
    amplitude: f64,
    partials: [[Partial; PARTIALS]; 2],
    time: f64,
}

impl Tremor {
    /// The tremor of `seed`.
    pub fn new(parameters: TremorParameters, seed: u64) -> Self {
        let mut random = Random::new(seed);
        let mut partials = [[Partial::default(); PARTIALS]; 2];
        for (index, partial) in partials.iter_mut().flatten().enumerate() {
            // One in each part of the band, so that they never fall together.
            let part = ((index % PARTIALS) as f64 + random.uniform()) / PARTIALS as f64;
            let hertz = BAND[0] + (BAND[1] - BAND[0]) * part;
            *partial = Partial {
                frequency: std::f64::consts::TAU * hertz,
                phase: std::f64::consts::TAU * random.uniform(),
            };
        }
        Tremor {
            amplitude: parameters.amplitude * (2.0 / PARTIALS as f64).sqrt(),
            partials,
            time: 0.0,
        }
    }

    /// Displacement \[m\] and its rate \[m/s\] after a further `dt` \[s\].
    pub fn step(&mut self, dt: f64) -> ([f64; 2], [f64; 2]) {
        self.time += dt;
        let (mut displacement, mut rate) = ([0.0; 2], [0.0; 2]);
        for axis in 0..2 {
            for partial in &self.partials[axis] {
                let (sine, cosine) = (partial.frequency * self.time + partial.phase).sin_cos();
                displacement[axis] += self.amplitude * sine;
                rate[axis] += self.amplitude * partial.frequency * cosine;
            }
        }
        (displacement, rate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn amplitude_and_band_are_as_given() {
        let mut tremor = Tremor::new(TremorParameters { amplitude: 5e-5 }, 3);
        let (mut square, mut crossings, mut before) = (0.0, 0, 0.0);
        let count = 100_000;
        for _ in 0..count {
            let x = tremor.step(1e-3).0[0];
            square += x * x;
            crossings += u32::from(before * x < 0.0);
            before = x;
        }
        let amplitude = (square / f64::from(count)).sqrt();
        assert!((amplitude / 5e-5 - 1.0).abs() < 0.02, "{amplitude} m");
        let hertz = f64::from(crossings) / 2.0 / 100.0;
        assert!((8.0..12.0).contains(&hertz), "{hertz} Hz");
    }
}
