//! Coulomb friction that grows with the load on the gear.

use super::{Description, Effect, FrictionState, sign};
use crate::Parameter;

/// τ_F = b_0T · |τ| · sign(q̇)
#[derive(Clone, Copy, Debug)]
pub struct LoadCoulomb;

static DESCRIPTION: Description = Description {
    name: "load_coulomb",
    equation: "τ_F = b_0T · |τ| · sign(q̇)",
    source: "ROKVISS, lessons learned, equation (3), second term",
    parameters: &[Parameter {
        name: "b_0T",
        unit: "-",
        lower: -1.0,
        upper: 1.0,
        doc: "load-dependent Coulomb friction; Table 1 has one set below zero, badly excited",
    }],
};

impl Effect for LoadCoulomb {
    fn description(&self) -> &'static Description {
        &DESCRIPTION
    }

    fn regressor(&self, state: &FrictionState, _memory: &[f64], row: &mut [f64]) {
        if let [x, ..] = row {
            *x = state.load.abs() * sign(state.velocity);
        }
    }
}
