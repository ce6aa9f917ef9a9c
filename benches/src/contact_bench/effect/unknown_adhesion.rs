//! Outside the catalogue: friction that is there without any normal force.

use ferntast_emulation::random::Random;

use super::{Effect, State, about};

struct UnknownAdhesion {
    /// \[N\]
    level: f64,
}

pub(super) fn draw(strength: f64, random: &mut Random) -> Box<dyn Effect> {
    Box::new(UnknownAdhesion {
        level: strength * about(1.0, random),
    })
}

impl Effect for UnknownAdhesion {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![("level", self.level, "N")]
    }

    fn holds(&self, state: &State) -> f64 {
        if state.normal_force > 0.0 {
            self.level
        } else {
            0.0
        }
    }
}
