//! Stribeck: Coulomb friction falls from rest to sliding,
//! b_s exp(−(q̇/v_s)²) sign(q̇) (Bo and Pavelescu 1982, exponent 2).
//! A bump near q̇ = 0.

use ferntast_emulation::random::Random;

use super::{Effect, Friction, State, about};

#[derive(Clone)]
struct Stribeck {
    /// b_s \[Nm\].
    bs: f64,
    /// v_s \[rad/s\].
    vs: f64,
}

pub(super) fn draw(strength: f64, random: &mut Random) -> Box<dyn Effect> {
    Box::new(Stribeck {
        bs: strength * about(5.0, random),
        vs: 0.02 + 0.03 * random.uniform(),
    })
}

impl Effect for Stribeck {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![("bs", self.bs, "Nm"), ("vs", self.vs, "rad/s")]
    }

    fn friction(&self, state: &State, friction: &mut Friction) {
        let ratio = state.velocity / self.vs;
        friction.level += self.bs * (-ratio * ratio).exp();
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}
