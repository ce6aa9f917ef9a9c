//! Coulomb friction of different level in the two directions.

use super::{
    Direction, Effect, EffectDescription, Exact, Memory, OwnSignals, Point, TORQUE, describe,
};

describe!(
    AsymmetricCoulomb,
    "asymmetric_coulomb",
    "τ_F = ba",
    "offset by direction, as in Janot, Gautier, Brunot 2019",
    coefficients: ["ba": TORQUE],
    shape: [],
    shows_as: "levels differ by direction",
    excited_by: "motion in both directions at two positions and without load",
    shown_by: WidePosition,
    taken_for: ["torque_sensor_offset", "gravity"]
);

impl Effect for AsymmetricCoulomb {
    fn description(&self) -> &EffectDescription {
        &self.0
    }

    fn evaluate(&self, _shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        let _ = point;
        columns.fill(1.0);
    }

    fn exact(&self) -> &'static [Exact] {
        &[Exact::One]
    }

    fn own_signals(&self) -> OwnSignals {
        OwnSignals {
            names: &["velocity", "position"],
            direction: Direction::Same,
            any_pair: false,
        }
    }
}
