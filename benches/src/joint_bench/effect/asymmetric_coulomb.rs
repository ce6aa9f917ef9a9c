//! Coulomb friction of b_0 + b_a one way and b_0 − b_a the other: b_a |bristle|,
//! which is b_a sign²(q̇) while sliding.
//! Levels differ by direction.

use ferntast_emulation::random::Random;

use super::{Effect, Friction, State, either_sign};

#[derive(Clone)]
struct AsymmetricCoulomb {
    /// b_a \[Nm\].
    ba: f64,
}

pub(super) fn draw(strength: f64, random: &mut Random) -> Box<dyn Effect> {
    Box::new(AsymmetricCoulomb {
        ba: strength * either_sign(1.5, random),
    })
}

impl Effect for AsymmetricCoulomb {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![("ba", self.ba, "Nm")]
    }

    fn friction(&self, state: &State, friction: &mut Friction) {
        friction.torque += self.ba * state.bristle.abs();
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}
