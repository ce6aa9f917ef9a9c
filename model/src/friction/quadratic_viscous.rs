//! Quadratic viscous friction.

use super::{Description, Effect, FrictionState};
use crate::Parameter;

/// τ_F = b_2 · q̇ · |q̇|
#[derive(Clone, Copy, Debug)]
pub struct QuadraticViscous;

static DESCRIPTION: Description = Description {
    name: "quadratic_viscous",
    equation: "τ_F = b_2 · q̇ · |q̇|",
    source: "ROKVISS, lessons learned, equation (4), fourth term",
    parameters: &[Parameter {
        name: "b_2",
        unit: "Nm·s²/rad²",
        lower: -10000.0,
        upper: 10000.0,
        doc: "quadratic viscous friction; below zero with space lubricant, so only the sum of the viscous terms dissipates",
    }],
};

impl Effect for QuadraticViscous {
    fn description(&self) -> &'static Description {
        &DESCRIPTION
    }

    fn regressor(&self, state: &FrictionState, _memory: &[f64], row: &mut [f64]) {
        if let [x, ..] = row {
            *x = state.velocity * state.velocity.abs();
        }
    }
}
