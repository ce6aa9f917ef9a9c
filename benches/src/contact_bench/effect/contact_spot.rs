//! A stretch of the edge with other friction, as from a scratch or a stain:
//! even in its middle, with soft ends. A bump over the place whose sign goes
//! with the direction.

use std::f64::consts::PI;

use ferntast_emulation::random::Random;

use super::{Effect, State, either_sign};
use crate::contact_bench::parameters::EdgeParameters;

struct ContactSpot {
    /// Change of b_0T \[-\].
    change: f64,
    /// Middle \[m\].
    centre: f64,
    /// From the middle to where the ends begin \[m\].
    even: f64,
    /// Length of an end \[m\].
    end: f64,
}

pub(super) fn draw(strength: f64, edge: &EdgeParameters, random: &mut Random) -> Box<dyn Effect> {
    let change = strength * either_sign(0.07, random);
    Box::new(ContactSpot {
        // Friction does not get below a quarter of what it is around.
        change: change.max(-0.75 * edge.b0t),
        centre: -0.02 + 0.04 * random.uniform(),
        even: 0.004 * random.uniform(),
        end: 0.006 + 0.006 * random.uniform(),
    })
}

impl Effect for ContactSpot {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![
            ("change", self.change, "-"),
            ("centre", self.centre, "m"),
            ("even", self.even, "m"),
            ("end", self.end, "m"),
        ]
    }

    fn holds(&self, state: &State) -> f64 {
        let beyond = (state.place - self.centre).abs() - self.even;
        let share = (beyond / self.end).clamp(0.0, 1.0);
        0.5 * (1.0 + (PI * share).cos()) * self.change * state.normal_force
    }
}
