//! Viscous friction that changes with temperature: k_v (T − T₀) q̇.
//! The slope over q̇ changes with T.

use ferntast_emulation::random::Random;

use super::{Effect, Friction, State, either_sign};

#[derive(Clone)]
struct TemperatureViscous {
    /// k_v \[Nm·s/(rad K)\].
    kv: f64,
    /// T₀ \[degC\].
    t0: f64,
}

pub(super) fn draw(strength: f64, random: &mut Random) -> Box<dyn Effect> {
    Box::new(TemperatureViscous {
        kv: strength * either_sign(0.55, random),
        t0: 10.0,
    })
}

impl Effect for TemperatureViscous {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![("kv", self.kv, "Nm·s/(rad K)"), ("t0", self.t0, "degC")]
    }

    fn friction(&self, state: &State, friction: &mut Friction) {
        friction.torque += self.kv * (state.temperature - self.t0) * state.velocity;
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}
