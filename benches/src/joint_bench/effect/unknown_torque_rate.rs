//! Outside the catalogue: Coulomb friction that is higher while the load builds
//! up and lower while it falls, a tanh(τ̇/r) sign(q̇).

use ferntast_emulation::random::Random;

use super::{Effect, Friction, State, either_sign};

#[derive(Clone)]
struct UnknownTorqueRate {
    /// a \[Nm\].
    level: f64,
    /// r \[Nm/s\].
    rate: f64,
}

pub(super) fn draw(strength: f64, random: &mut Random) -> Box<dyn Effect> {
    Box::new(UnknownTorqueRate {
        level: strength * either_sign(2.5, random),
        rate: 3.0,
    })
}

impl Effect for UnknownTorqueRate {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![("level", self.level, "Nm"), ("rate", self.rate, "Nm/s")]
    }

    fn friction(&self, state: &State, friction: &mut Friction) {
        friction.level += self.level * (state.load_rate / self.rate).tanh();
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}
