//! Outside the catalogue: friction that differs by direction, as along the
//! grain and against it.

use ferntast_emulation::random::Random;

use super::{Effect, State, either_sign};
use crate::contact_bench::parameters::EdgeParameters;

struct UnknownDirection {
    /// More of b_0T towards larger places, less towards smaller ones \[-\].
    change: f64,
}

pub(super) fn draw(strength: f64, edge: &EdgeParameters, random: &mut Random) -> Box<dyn Effect> {
    Box::new(UnknownDirection {
        change: strength * either_sign(0.2, random) * edge.b0t,
    })
}

impl Effect for UnknownDirection {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![("change", self.change, "-")]
    }

    fn holds(&self, state: &State) -> f64 {
        self.change * state.direction * state.normal_force
    }
}
