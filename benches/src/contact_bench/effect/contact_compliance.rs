//! What carries the tip gives way along the edge: after a turn of the motors the
//! tip rests until the spring between them has wound up the other way. F_T has
//! the wrong sign near rest (the paper's Fig. 16).

use ferntast_emulation::random::Random;

use super::{Effect, about};
use crate::contact_bench::parameters::{EdgeParameters, TYPICAL_FORCE};

struct ContactCompliance {
    /// \[N/m\]
    stiffness: f64,
}

pub(super) fn draw(strength: f64, edge: &EdgeParameters, random: &mut Random) -> Box<dyn Effect> {
    // The spring's travel under the typical force.
    let travel = strength * about(3e-4, random);
    Box::new(ContactCompliance {
        stiffness: edge.b0t * TYPICAL_FORCE / travel,
    })
}

impl Effect for ContactCompliance {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![("stiffness", self.stiffness, "N/m")]
    }

    fn prepare(&self, edge: &mut EdgeParameters) {
        edge.stiffness = self.stiffness;
    }
}
