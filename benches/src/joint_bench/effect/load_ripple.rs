//! A gain that is periodic in the wave generator's turn: A τ sin(n N q + φ), with n as of
//! [`ripple`](super::ripple), of a harmonic drive or of the torque sensor on it (Taghirad and
//! Bélanger 1998). Periodic in q, and the higher the larger the load.

use std::f64::consts::TAU;

use ferntast_emulation::random::Random;

use super::{Effect, Friction, State, about, ripple};

#[derive(Clone)]
struct LoadRipple {
    /// A \[-\].
    gain: f64,
    /// n N: periods a radian, times 2π \[-\].
    rate: f64,
    /// φ \[rad\].
    phase: f64,
}

pub(super) fn draw(strength: f64, gear_ratio: f64, random: &mut Random) -> Box<dyn Effect> {
    let rate = ripple::order(random) * gear_ratio;
    Box::new(LoadRipple {
        gain: strength * about(0.3, random),
        rate,
        phase: TAU * random.uniform(),
    })
}

impl Effect for LoadRipple {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![
            ("gain", self.gain, "-"),
            ("rate", self.rate, "-"),
            ("phase", self.phase, "rad"),
        ]
    }

    fn friction(&self, state: &State, friction: &mut Friction) {
        let wave = (self.rate * state.position + self.phase).sin();
        friction.torque += self.gain * state.load * wave;
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}
