//! Viscous friction whose slope differs by direction, b_av |q̇|.
//! Slopes over q̇ that differ by direction.

use ferntast_emulation::random::Random;

use super::{Effect, Friction, State, either_sign};

#[derive(Clone)]
struct AsymmetricViscous {
    /// b_av \[Nm·s/rad\].
    bav: f64,
}

pub(super) fn draw(strength: f64, random: &mut Random) -> Box<dyn Effect> {
    Box::new(AsymmetricViscous {
        bav: strength * either_sign(15.0, random),
    })
}

impl Effect for AsymmetricViscous {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![("bav", self.bav, "Nm·s/rad")]
    }

    fn friction(&self, state: &State, friction: &mut Friction) {
        friction.torque += self.bav * state.velocity.abs();
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}

#[cfg(test)]
mod tests {
    use crate::joint_bench::{HiddenEffect, tests::signatures::standard};

    #[test]
    fn slopes_differ_by_direction() {
        let c = standard(HiddenEffect::AsymmetricViscous);
        c.is(0.1, |row| c.get("bav") * row.v.abs());
    }
}
