//! Outside the catalogue: Coulomb friction that falls as the joint's own work
//! warms the lubricant, −c W sign(q̇), where W is the work of friction that has
//! not leaked away yet: Ẇ = |τ_F q̇| − W/t_W. The temperature sensor, in the
//! housing, does not feel it.

use ferntast_emulation::random::Random;

use super::{Effect, Friction, State, about};

#[derive(Clone)]
struct UnknownWorkHeating {
    /// c \[Nm/J\].
    coefficient: f64,
    /// t_W \[s\].
    leak: f64,
    /// W \[J\].
    work: f64,
}

pub(super) fn draw(strength: f64, random: &mut Random) -> Box<dyn Effect> {
    Box::new(UnknownWorkHeating {
        coefficient: strength * about(0.045, random),
        leak: about(12.0, random),
        work: 0.0,
    })
}

impl Effect for UnknownWorkHeating {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![
            ("coefficient", self.coefficient, "Nm/J"),
            ("leak", self.leak, "s"),
        ]
    }

    fn friction(&self, _state: &State, friction: &mut Friction) {
        friction.level -= self.coefficient * self.work;
    }

    fn reset(&mut self) {
        self.work = 0.0;
    }

    fn tick(&mut self, work: f64) {
        self.work += work - 0.001 * self.work / self.leak;
    }

    fn boxed(&self) -> Box<dyn Effect> {
        Box::new(self.clone())
    }
}
