//! More Coulomb friction at one position, as from a worn spot:
//! a exp(−((q − q_c)/w)²) sign(q̇).
//! A bump at one q whose sign goes with the direction.

use ferntast_emulation::random::Random;

use super::{Effect, Friction, State, about};

#[derive(Clone)]
struct LocalFriction {
    /// a \[Nm\].
    level: f64,
    /// q_c \[rad\].
    centre: f64,
    /// w \[rad\].
    width: f64,
}

pub(super) fn draw(strength: f64, random: &mut Random) -> Box<dyn Effect> {
    Box::new(LocalFriction {
        level: strength * about(6.0, random),
        centre: 0.06 + 0.26 * random.uniform(),
        width: 0.02 + 0.03 * random.uniform(),
    })
}

impl Effect for LocalFriction {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![
            ("level", self.level, "Nm"),
            ("centre", self.centre, "rad"),
            ("width", self.width, "rad"),
        ]
    }

    fn friction(&self, state: &State, friction: &mut Friction) {
        let off = (state.position - self.centre) / self.width;
        friction.level += self.level * (-off * off).exp();
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}
