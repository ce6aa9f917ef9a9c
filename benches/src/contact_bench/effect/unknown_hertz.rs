//! Outside the catalogue: friction that grows more slowly than the normal
//! force, at full strength as F_N^(2/3), the area of a sphere's contact (Hertz).

use super::Effect;
use crate::contact_bench::parameters::EdgeParameters;

struct UnknownHertz {
    /// Of F_N \[-\].
    exponent: f64,
}

pub(super) fn draw(strength: f64) -> Box<dyn Effect> {
    Box::new(UnknownHertz {
        exponent: 1.0 - strength / 3.0,
    })
}

impl Effect for UnknownHertz {
    fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        vec![("exponent", self.exponent, "-")]
    }

    fn prepare(&self, edge: &mut EdgeParameters) {
        edge.exponent = self.exponent;
    }
}
