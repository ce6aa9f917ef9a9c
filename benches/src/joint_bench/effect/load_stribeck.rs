//! Stribeck friction that grows with the load: b_sT |τ| exp(−(q̇/v_s)²) sign(q̇)
//! (Bittencourt and Gunnarsson 2012, who found it in an industrial robot's joint).
//! A bump near q̇ = 0, the higher the larger the load.

use ferntast_emulation::random::Random;

use super::{Effect, Friction, State, about};

#[derive(Clone)]
struct LoadStribeck {
    /// b_sT \[-\].
    bst: f64,
    /// v_s \[rad/s\].
    vs: f64,
}

pub(super) fn draw(strength: f64, random: &mut Random) -> Box<dyn Effect> {
    Box::new(LoadStribeck {
        bst: strength * about(0.5, random),
        vs: 0.03 + 0.04 * random.uniform(),
    })
}

impl Effect for LoadStribeck {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![("bsT", self.bst, "-"), ("vs", self.vs, "rad/s")]
    }

    fn friction(&self, state: &State, friction: &mut Friction) {
        let ratio = state.velocity / self.vs;
        friction.level += self.bst * state.load.abs() * (-ratio * ratio).exp();
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}

#[cfg(test)]
mod tests {
    use crate::joint_bench::{HiddenEffect, tests::signatures::standard};

    #[test]
    fn it_is_a_bump_near_rest_that_grows_with_the_load() {
        let c = standard(HiddenEffect::LoadStribeck);
        c.is(0.2, |row| {
            let bump = (-(row.v / c.get("vs")).powi(2)).exp();
            c.get("bsT") * row.tau.abs() * bump * row.s()
        });
    }
}
