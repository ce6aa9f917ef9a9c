//! Outside the catalogue: Coulomb friction that is higher while the speed
//! changes, whether up or down, a tanh(|q̈|/r) sign(q̇).

use ferntast_emulation::random::Random;

use super::{Effect, Friction, State, about};

#[derive(Clone)]
struct UnknownAcceleration {
    /// a \[Nm\].
    level: f64,
    /// r \[rad/s²\].
    rate: f64,
}

pub(super) fn draw(strength: f64, random: &mut Random) -> Box<dyn Effect> {
    Box::new(UnknownAcceleration {
        level: strength * about(4.0, random),
        rate: 0.8,
    })
}

impl Effect for UnknownAcceleration {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![("level", self.level, "Nm"), ("rate", self.rate, "rad/s²")]
    }

    fn friction(&self, state: &State, friction: &mut Friction) {
        friction.level += self.level * (state.acceleration.abs() / self.rate).tanh();
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}
