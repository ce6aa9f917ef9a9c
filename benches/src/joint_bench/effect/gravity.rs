//! Weight that acts on the motor side of the torque sensor: g sin(q + φ).
//! Over q, whatever the direction.

use std::f64::consts::TAU;

use ferntast_emulation::random::Random;

use super::{Effect, Friction, State, about};

#[derive(Clone)]
struct Gravity {
    /// g \[Nm\].
    g: f64,
    /// φ \[rad\].
    phase: f64,
}

pub(super) fn draw(strength: f64, random: &mut Random) -> Box<dyn Effect> {
    Box::new(Gravity {
        g: strength * about(4.0, random),
        phase: TAU * random.uniform(),
    })
}

impl Effect for Gravity {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![("g", self.g, "Nm"), ("phase", self.phase, "rad")]
    }

    fn friction(&self, state: &State, friction: &mut Friction) {
        friction.torque += self.g * (state.position + self.phase).sin();
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}
