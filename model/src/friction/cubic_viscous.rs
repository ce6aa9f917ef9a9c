//! Cubic viscous friction.

use super::{Description, Effect, FrictionState};
use crate::Parameter;

/// τ_F = b_3 · q̇³
#[derive(Clone, Copy, Debug)]
pub struct CubicViscous;

static DESCRIPTION: Description = Description {
    name: "cubic_viscous",
    equation: "τ_F = b_3 · q̇³",
    source: "ROKVISS, lessons learned, equation (4), fifth term",
    parameters: &[Parameter {
        name: "b_3",
        unit: "Nm·s³/rad³",
        lower: -10000.0,
        upper: 10000.0,
        doc: "cubic viscous friction",
    }],
};

impl Effect for CubicViscous {
    fn description(&self) -> &'static Description {
        &DESCRIPTION
    }

    fn regressor(&self, state: &FrictionState, _memory: &[f64], row: &mut [f64]) {
        if let [x, ..] = row {
            *x = state.velocity.powi(3);
        }
    }
}
