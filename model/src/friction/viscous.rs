//! Viscous friction: proportional to velocity.

use super::{Description, Effect, FrictionState};
use crate::Parameter;

/// τ_F = b_1 · q̇
#[derive(Clone, Copy, Debug)]
pub struct Viscous;

static DESCRIPTION: Description = Description {
    name: "viscous",
    equation: "τ_F = b_1 · q̇",
    source: "ROKVISS, lessons learned, equation (3), third term",
    parameters: &[Parameter {
        name: "b_1",
        unit: "Nm·s/rad",
        lower: 0.0,
        upper: 5000.0,
        doc: "viscous damping",
    }],
};

impl Effect for Viscous {
    fn description(&self) -> &'static Description {
        &DESCRIPTION
    }

    fn regressor(&self, state: &FrictionState, _memory: &[f64], row: &mut [f64]) {
        if let [x, ..] = row {
            *x = state.velocity;
        }
    }
}
