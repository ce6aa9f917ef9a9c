//! Outside the catalogue: friction that changes with temperature.

use ferntast_emulation::random::Random;

use super::{Effect, State, either_sign};
use crate::contact_bench::parameters::EdgeParameters;

/// \[degC\]
const REFERENCE: f64 = 10.0;

struct UnknownTemperature {
    /// Change of b_0T \[1/K\].
    change: f64,
}

pub(super) fn draw(strength: f64, edge: &EdgeParameters, random: &mut Random) -> Box<dyn Effect> {
    Box::new(UnknownTemperature {
        change: strength * either_sign(0.02, random) * edge.b0t,
    })
}

impl Effect for UnknownTemperature {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![("change", self.change, "1/K")]
    }

    fn holds(&self, state: &State) -> f64 {
        self.change * (state.temperature - REFERENCE) * state.normal_force
    }
}
