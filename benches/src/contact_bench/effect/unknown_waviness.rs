//! Outside the catalogue: the edge is not as straight as it is believed, so that
//! a part of the normal force pushes along it, whatever the direction of motion.

use std::f64::consts::TAU;

use ferntast_emulation::random::Random;

use super::{Effect, State, about};

struct UnknownWaviness {
    /// Steepest slope \[-\].
    slope: f64,
    /// \[m\]
    wavelength: f64,
    /// \[rad\]
    phase: f64,
}

pub(super) fn draw(strength: f64, random: &mut Random) -> Box<dyn Effect> {
    Box::new(UnknownWaviness {
        slope: strength * about(0.04, random),
        wavelength: 0.04 + 0.04 * random.uniform(),
        phase: TAU * random.uniform(),
    })
}

impl Effect for UnknownWaviness {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![
            ("slope", self.slope, "-"),
            ("wavelength", self.wavelength, "m"),
            ("phase", self.phase, "rad"),
        ]
    }

    fn along(&self, state: &State) -> f64 {
        let angle = TAU * state.place / self.wavelength + self.phase;
        self.slope * angle.sin() * state.normal_force
    }
}
