//! Torque periodic in the wave generator's turn (Kennedy and Desai 2005):
//! A sin(n N q + φ), with n = 2 for an oval wave generator, sometimes 1 or 4.
//! Periodic in q.

use std::f64::consts::TAU;

use ferntast_emulation::random::Random;

use super::{Effect, Friction, State, about};

#[derive(Clone)]
struct Ripple {
    /// A \[Nm\].
    amplitude: f64,
    /// n N: periods a radian, times 2π \[-\].
    rate: f64,
    /// φ \[rad\].
    phase: f64,
}

/// n.
pub(super) fn order(random: &mut Random) -> f64 {
    match random.uniform() {
        which if which < 0.6 => 2.0,
        which if which < 0.8 => 1.0,
        _ => 4.0,
    }
}

pub(super) fn draw(strength: f64, gear_ratio: f64, random: &mut Random) -> Box<dyn Effect> {
    let order = order(random);
    Box::new(Ripple {
        amplitude: strength * about(2.5, random),
        rate: order * gear_ratio,
        phase: TAU * random.uniform(),
    })
}

impl Effect for Ripple {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![
            ("amplitude", self.amplitude, "Nm"),
            ("rate", self.rate, "-"),
            ("phase", self.phase, "rad"),
        ]
    }

    fn friction(&self, state: &State, friction: &mut Friction) {
        friction.torque += self.amplitude * (self.rate * state.position + self.phase).sin();
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}
