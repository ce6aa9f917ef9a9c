//! Outside the catalogue: a slow oscillation in time, a sin(2π t/P + φ), as of
//! a supply that sways.

use std::f64::consts::TAU;

use ferntast_emulation::random::Random;

use super::{Effect, Friction, State, about};

#[derive(Clone)]
struct UnknownOscillation {
    /// a \[Nm\].
    torque: f64,
    /// P \[s\].
    period: f64,
    /// φ \[rad\].
    phase: f64,
}

pub(super) fn draw(strength: f64, random: &mut Random) -> Box<dyn Effect> {
    Box::new(UnknownOscillation {
        torque: strength * about(2.0, random),
        period: 8.0 + 10.0 * random.uniform(),
        phase: TAU * random.uniform(),
    })
}

impl Effect for UnknownOscillation {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![
            ("torque", self.torque, "Nm"),
            ("period", self.period, "s"),
            ("phase", self.phase, "rad"),
        ]
    }

    fn friction(&self, state: &State, friction: &mut Friction) {
        friction.torque += self.torque * (TAU * state.time / self.period + self.phase).sin();
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}
