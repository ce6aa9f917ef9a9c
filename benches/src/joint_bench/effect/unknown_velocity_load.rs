//! Outside the catalogue: viscous friction that grows with the square of the
//! load, c τ² q̇.

use ferntast_emulation::random::Random;

use super::{Effect, Friction, State, about};

#[derive(Clone)]
struct UnknownVelocityLoad {
    /// c \[s/(Nm rad)\].
    coefficient: f64,
}

pub(super) fn draw(strength: f64, random: &mut Random) -> Box<dyn Effect> {
    Box::new(UnknownVelocityLoad {
        coefficient: strength * about(0.07, random),
    })
}

impl Effect for UnknownVelocityLoad {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![("coefficient", self.coefficient, "s/(Nm rad)")]
    }

    fn friction(&self, state: &State, friction: &mut Friction) {
        friction.torque += self.coefficient * state.load * state.load * state.velocity;
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}
