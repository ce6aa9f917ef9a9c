//! Coulomb friction that grows with the days: k_w t sign(q̇) (the paper's Fig. 10).
//! The step at q̇ = 0 changes with the date.

use ferntast_emulation::random::Random;

use super::{Effect, Friction, State, about};

#[derive(Clone)]
struct WearDrift {
    /// k_w \[Nm/day\].
    kw: f64,
}

pub(super) fn draw(strength: f64, random: &mut Random) -> Box<dyn Effect> {
    Box::new(WearDrift {
        kw: strength * about(0.014, random),
    })
}

impl Effect for WearDrift {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![("kw", self.kw, "Nm/day")]
    }

    fn friction(&self, state: &State, friction: &mut Friction) {
        friction.level += self.kw * state.date;
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}
