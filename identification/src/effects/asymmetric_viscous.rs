//! Viscous friction of different slope in the two directions.

use super::{Direction, Effect, EffectDescription, Memory, OwnSignals, Point, Unit, describe};

describe!(
    AsymmetricViscous,
    "asymmetric_viscous",
    "τ_F = bav · |q̇|",
    "slope by direction, as in Janot, Gautier, Brunot 2019",
    coefficients: ["bav": Unit::new("Nm s/rad", "N s/m")],
    shape: [],
    shows_as: "slopes over q̇ differ by direction",
    excited_by: "several speeds in both directions",
    shown_by: WideSpeedRange,
    taken_for: ["asymmetric_coulomb"]
);

impl Effect for AsymmetricViscous {
    fn description(&self) -> &EffectDescription {
        &self.0
    }

    fn evaluate(&self, _shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        if let [c] = columns {
            *c = point.velocity.abs();
        }
    }

    // A slope that differs by direction without a level that does is a
    // part of an asymmetry: not simpler than one cause with one number.
    fn freedom(&self) -> usize {
        2
    }

    fn own_signals(&self) -> OwnSignals {
        OwnSignals {
            names: &["velocity"],
            direction: Direction::Same,
            any_pair: false,
        }
    }
}
