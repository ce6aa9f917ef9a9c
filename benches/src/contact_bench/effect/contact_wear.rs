//! Friction that changes with the days towards a last value, as a lubricant
//! that wears off (the paper's Fig. 17).

use ferntast_emulation::random::Random;

use super::{Effect, State, about};
use crate::contact_bench::parameters::EdgeParameters;

struct ContactWear {
    /// Change of b_0T in the end \[-\].
    change: f64,
    /// Half of it is done after \[days\].
    half_life: f64,
}

pub(super) fn draw(strength: f64, edge: &EdgeParameters, random: &mut Random) -> Box<dyn Effect> {
    Box::new(ContactWear {
        change: strength * about(0.6, random) * edge.b0t,
        half_life: 40.0 + 200.0 * random.uniform(),
    })
}

impl Effect for ContactWear {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![
            ("change", self.change, "-"),
            ("half_life", self.half_life, "d"),
        ]
    }

    fn holds(&self, state: &State) -> f64 {
        let left = 0.5_f64.powf(state.date / self.half_life);
        self.change * (1.0 - left) * state.normal_force
    }
}
