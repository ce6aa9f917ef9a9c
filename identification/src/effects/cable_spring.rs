//! A cable or spring that pulls the joint back.

use super::{
    Direction, Effect, EffectDescription, Exact, Memory, OwnSignals, Point, TORQUE, Unit, describe,
};

describe!(
    CableSpring,
    "cable_spring",
    "τ = kc · (q − q0) = kc · q + k0",
    "Hooke",
    coefficients: ["kc": Unit::new("Nm/rad", "N/m"), "k0": TORQUE],
    shape: [],
    shows_as: "straight line over q, whatever the sign of q̇",
    excited_by: "slow motion over the whole range of positions without load",
    shown_by: WidePosition,
    taken_for: ["gravity", "torque_sensor_gain"]
);

impl Effect for CableSpring {
    fn description(&self) -> &EffectDescription {
        &self.0
    }

    fn evaluate(&self, _shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        if let [slope, level] = columns {
            *slope = point.position;
            *level = 1.0;
        }
    }

    fn exact(&self) -> &'static [Exact] {
        &[Exact::Position, Exact::One]
    }

    fn is_load(&self) -> bool {
        true
    }

    fn own_signals(&self) -> OwnSignals {
        OwnSignals {
            names: &["position"],
            direction: Direction::Same,
            any_pair: false,
        }
    }
}
