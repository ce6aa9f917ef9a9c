//! Outside the catalogue: viscous friction that grows with the normal force.

use ferntast_emulation::random::Random;

use super::{Effect, State, about};

struct UnknownSpeedForce {
    /// \[s/m\]
    coefficient: f64,
}

pub(super) fn draw(strength: f64, random: &mut Random) -> Box<dyn Effect> {
    Box::new(UnknownSpeedForce {
        coefficient: strength * about(2.0, random),
    })
}

impl Effect for UnknownSpeedForce {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![("coefficient", self.coefficient, "s/m")]
    }

    fn damping(&self, state: &State) -> f64 {
        self.coefficient * state.normal_force
    }
}
