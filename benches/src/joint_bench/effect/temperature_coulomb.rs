//! Coulomb friction that falls as the lubricant warms: k_T (T − T₀) sign(q̇)
//! (the paper's Figs. 12 and 14 for the direction).
//! The step at q̇ = 0 changes with T.

use ferntast_emulation::random::Random;

use super::{Effect, Friction, State, about};

#[derive(Clone)]
struct TemperatureCoulomb {
    /// k_T \[Nm/K\].
    kt: f64,
    /// T₀ \[degC\].
    t0: f64,
}

pub(super) fn draw(strength: f64, random: &mut Random) -> Box<dyn Effect> {
    Box::new(TemperatureCoulomb {
        kt: -strength * about(0.16, random),
        t0: 10.0,
    })
}

impl Effect for TemperatureCoulomb {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![("kt", self.kt, "Nm/K"), ("t0", self.t0, "degC")]
    }

    fn friction(&self, state: &State, friction: &mut Friction) {
        friction.level += self.kt * (state.temperature - self.t0);
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}
