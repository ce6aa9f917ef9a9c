//! Stribeck: friction falls from rest to sliding, b_s exp(−(ṙ/v_s)²) F_N (Bo
//! and Pavelescu 1982, exponent 2). A bump near ṙ = 0.

use ferntast_emulation::random::Random;

use super::{Effect, State, about};

struct ContactStribeck {
    /// b_s \[-\].
    bs: f64,
    /// v_s \[m/s\].
    vs: f64,
}

pub(super) fn draw(strength: f64, random: &mut Random) -> Box<dyn Effect> {
    Box::new(ContactStribeck {
        bs: strength * about(0.08, random),
        vs: 0.003 + 0.006 * random.uniform(),
    })
}

impl Effect for ContactStribeck {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![("bs", self.bs, "-"), ("vs", self.vs, "m/s")]
    }

    fn holds(&self, state: &State) -> f64 {
        let ratio = state.speed / self.vs;
        self.bs * (-ratio * ratio).exp() * state.normal_force
    }
}
