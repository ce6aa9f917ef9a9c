//! Viscous friction that changes with temperature.

use super::{
    Direction, Effect, EffectDescription, Facts, Memory, OwnSignals, Point, Unit, describe,
};

describe!(
    TemperatureViscous,
    "temperature_viscous",
    "τ_F = kv · (T − T0) · q̇",
    "ROKVISS, lessons learned, Figs. 12 and 14",
    coefficients: ["kv": Unit::new("Nm s/(rad K)", "N s/(m K)")],
    shape: [],
    shows_as: "slope changes with T",
    excited_by: "slow and fast motion at several temperatures",
    shown_by: TemperatureSweep,
    taken_for: ["temperature_coulomb"]
);

impl Effect for TemperatureViscous {
    fn description(&self) -> &EffectDescription {
        &self.0
    }

    fn evaluate(&self, _shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        if let [c] = columns {
            *c = point.temperature * point.velocity;
        }
    }

    fn unavailable(&self, facts: &Facts) -> Option<String> {
        facts.no_temperature()
    }

    fn between_sessions(&self) -> bool {
        true
    }

    fn varies(&self) -> Option<&'static str> {
        Some("viscous")
    }

    fn own_signals(&self) -> OwnSignals {
        OwnSignals {
            names: &["temperature"],
            direction: Direction::Either,
            any_pair: true,
        }
    }
}
