//! Coulomb friction that changes with the date.

use super::{
    Direction, Effect, EffectDescription, Facts, Memory, OwnSignals, Point, Unit, describe,
};

describe!(
    WearDrift,
    "wear_drift",
    "τ_F = kw · t · sign(q̇), t in days",
    "ROKVISS, lessons learned, Fig. 10",
    coefficients: ["kw": Unit::new("Nm/day", "N/day")],
    shape: [],
    shows_as: "step changes with date",
    excited_by: "the same motion at one temperature on many dates",
    shown_by: DateSweep,
    taken_for: ["temperature_coulomb"]
);

impl Effect for WearDrift {
    fn description(&self) -> &EffectDescription {
        &self.0
    }

    fn evaluate(&self, _shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        if let [c] = columns {
            *c = point.days * point.sign();
        }
    }

    fn unavailable(&self, facts: &Facts) -> Option<String> {
        (facts.sessions < 4 || facts.days < 0.5)
            .then(|| "fewer than four sessions or all on one day".to_owned())
    }

    fn between_sessions(&self) -> bool {
        true
    }

    fn varies(&self) -> Option<&'static str> {
        Some("coulomb")
    }

    fn own_signals(&self) -> OwnSignals {
        OwnSignals {
            names: &["date"],
            direction: Direction::Either,
            any_pair: true,
        }
    }
}
