//! Coulomb friction that changes with temperature.

use super::{
    Direction, Effect, EffectDescription, Facts, Memory, OwnSignals, Point, Unit, describe,
};

describe!(
    TemperatureCoulomb,
    "temperature_coulomb",
    "τ_F = kT · (T − T0) · sign(q̇)",
    "ROKVISS, lessons learned, Figs. 12 and 14",
    coefficients: ["kT": Unit::new("Nm/K", "N/K")],
    shape: [],
    shows_as: "step changes with T",
    excited_by: "slow motion at several temperatures, on dates out of order with temperature",
    shown_by: TemperatureSweep,
    taken_for: ["wear_drift"]
);

impl Effect for TemperatureCoulomb {
    fn description(&self) -> &EffectDescription {
        &self.0
    }

    fn evaluate(&self, _shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        if let [c] = columns {
            *c = point.temperature * point.sign();
        }
    }

    fn unavailable(&self, facts: &Facts) -> Option<String> {
        facts.no_temperature()
    }

    fn between_sessions(&self) -> bool {
        true
    }

    fn varies(&self) -> Option<&'static str> {
        Some("coulomb")
    }

    fn own_signals(&self) -> OwnSignals {
        OwnSignals {
            names: &["temperature"],
            direction: Direction::Either,
            any_pair: true,
        }
    }
}
