//! Noise and quantisation of what is logged.

use ferntast_emulation::random::Random;

/// Standard deviation of each reading's noise. Assumed: 0.02 Nm at the joints
/// over levers of 0.2 m; encoders of 20 bits a turn at 0.35 m.
const FORCE: f64 = 0.12;
/// Noise of F_T that outlasts a sample, and what is left of it after one.
const FORCE_SLOW: f64 = 0.06;
const SLOW_KEPT: f64 = 0.88;
const PLACE: f64 = 2e-6;
const PLACE_QUANTUM: f64 = 2e-6;
const TEMPERATURE: f64 = 0.05;

/// What sensors say.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Reading {
    /// \[m\]
    pub(super) place: f64,
    /// F_T \[N\].
    pub(super) tangential: f64,
    /// F_N \[N\].
    pub(super) normal: f64,
}

/// Turns readings into what a log holds.
#[derive(Clone, Debug)]
pub(super) struct Sensors {
    noise: f64,
    slow: f64,
    random: Random,
}

impl Sensors {
    pub(super) fn new(noise: f64, random: Random) -> Self {
        Sensors {
            noise,
            slow: 0.0,
            random,
        }
    }

    fn draw(&mut self, deviation: f64) -> f64 {
        self.noise * deviation * self.random.normal()
    }

    /// `reading` with noise.
    pub(super) fn log(&mut self, reading: &Reading) -> Reading {
        let fresh = self.draw(FORCE_SLOW * (1.0 - SLOW_KEPT * SLOW_KEPT).sqrt());
        self.slow = SLOW_KEPT * self.slow + fresh;
        let place = reading.place + self.draw(PLACE);
        Reading {
            place: match self.noise > 0.0 {
                true => (place / PLACE_QUANTUM).round() * PLACE_QUANTUM,
                false => place,
            },
            tangential: reading.tangential + self.slow + self.draw(FORCE),
            normal: reading.normal + self.draw(FORCE),
        }
    }

    /// The temperature \[degC\] with noise.
    pub(super) fn temperature(&mut self, temperature: f64) -> f64 {
        temperature + self.draw(TEMPERATURE)
    }
}
