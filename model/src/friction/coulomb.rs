//! Coulomb friction: constant, against the motion.

use super::{Description, Effect, FrictionState, sign};
use crate::Parameter;

/// τ_F = b_0 · sign(q̇)
#[derive(Clone, Copy, Debug)]
pub struct Coulomb;

static DESCRIPTION: Description = Description {
    name: "coulomb",
    equation: "τ_F = b_0 · sign(q̇)",
    source: "ROKVISS, lessons learned, equation (3), first term",
    parameters: &[Parameter {
        name: "b_0",
        unit: "Nm",
        lower: 0.0,
        upper: 200.0,
        doc: "constant Coulomb friction",
    }],
};

impl Effect for Coulomb {
    fn description(&self) -> &'static Description {
        &DESCRIPTION
    }

    fn regressor(&self, state: &FrictionState, _memory: &[f64], row: &mut [f64]) {
        if let [x, ..] = row {
            *x = sign(state.velocity);
        }
    }
}
