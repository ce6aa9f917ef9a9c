//! Friction that changes with temperature and date.

use super::facts::Facts;
use super::proposal::{Contrast, Proposal};
use super::row::{EffectParameter, OwnSignals, Row, Unit};
use super::static_effect::{Signal, StaticEffect};

/// All of them.
pub(super) static EFFECTS: &[StaticEffect] = &[
    StaticEffect {
        row: Row {
            id: "temperature_coulomb",
            equation: "τ_F = kT · (T − T0) · sign(q̇)",
            source: "ROKVISS, lessons learned, Figs. 12 and 14",
            coefficients: &[EffectParameter::new(
                "kT",
                Unit::new("Nm/K", "N/K"),
                -20.0,
                20.0,
            )],
            shows_as: "step changes with T",
            excited_by: "slow motion at several temperatures, on dates out of order with temperature",
            shown_by: Proposal::TemperatureSweep,
            contrasts: &[Contrast::TemperatureSweep],
            confusable_with: &["wear_drift"],
            varies: Some("coulomb"),
            own_signals: OwnSignals::varying(&["temperature"]),
            ..Row::NONE
        },
        reads: &[Signal::Velocity, Signal::Temperature],
        columns: |state, _, columns| columns.fill(state.temperature * state.sign()),
        unavailable: Facts::no_temperature,
        ..StaticEffect::NONE
    },
    StaticEffect {
        row: Row {
            id: "temperature_viscous",
            equation: "τ_F = kv · (T − T0) · q̇",
            source: "ROKVISS, lessons learned, Figs. 12 and 14",
            coefficients: &[EffectParameter::new(
                "kv",
                Unit::new("Nm s/(rad K)", "N s/(m K)"),
                -500.0,
                500.0,
            )],
            shows_as: "slope changes with T",
            excited_by: "slow and fast motion at several temperatures",
            shown_by: Proposal::TemperatureSweep,
            contrasts: &[Contrast::TemperatureSweep],
            confusable_with: &["temperature_coulomb"],
            varies: Some("viscous"),
            own_signals: OwnSignals::varying(&["temperature"]),
            ..Row::NONE
        },
        reads: &[Signal::Velocity, Signal::Temperature],
        columns: |state, _, columns| columns.fill(state.temperature * state.velocity),
        unavailable: Facts::no_temperature,
        ..StaticEffect::NONE
    },
    StaticEffect {
        row: Row {
            id: "temperature_coulomb_curve",
            equation: "τ_F = kT2 · (T − T0)² · sign(q̇)",
            source: "second order of what the lubricant does over the temperature",
            coefficients: &[EffectParameter::new(
                "kT2",
                Unit::new("Nm/K²", "N/K²"),
                -1.0,
                1.0,
            )],
            shows_as: "step changes with T, the more the colder it is",
            excited_by: "slow motion at five temperatures or more, as far apart as they get",
            shown_by: Proposal::TemperatureSweep,
            contrasts: &[Contrast::TemperatureSweep],
            confusable_with: &["temperature_viscous_curve"],
            varies: Some("coulomb"),
            own_signals: OwnSignals::varying(&["temperature"]),
            another: Some("temperature_coulomb"),
            ..Row::NONE
        },
        reads: &[Signal::Velocity, Signal::Temperature],
        columns: |state, _, columns| columns.fill(state.temperature.powi(2) * state.sign()),
        unavailable: Facts::too_few_temperatures,
        ..StaticEffect::NONE
    },
    StaticEffect {
        row: Row {
            id: "temperature_viscous_curve",
            equation: "τ_F = kv2 · (T − T0)² · q̇",
            source: "second order of the viscosity of oil and grease, which falls exponentially (Vogel, Physikalische Zeitschrift 22, 1921)",
            coefficients: &[EffectParameter::new(
                "kv2",
                Unit::new("Nm s/(rad K²)", "N s/(m K²)"),
                -20.0,
                20.0,
            )],
            shows_as: "slope changes with T, the more the colder it is",
            excited_by: "slow and fast motion at five temperatures or more, as far apart as they get",
            shown_by: Proposal::TemperatureSweep,
            contrasts: &[Contrast::TemperatureSweep],
            confusable_with: &["temperature_coulomb_curve"],
            varies: Some("viscous"),
            own_signals: OwnSignals::varying(&["temperature"]),
            another: Some("temperature_viscous"),
            ..Row::NONE
        },
        reads: &[Signal::Velocity, Signal::Temperature],
        columns: |state, _, columns| columns.fill(state.temperature.powi(2) * state.velocity),
        unavailable: Facts::too_few_temperatures,
        ..StaticEffect::NONE
    },
    StaticEffect {
        row: Row {
            id: "wear_drift",
            equation: "τ_F = kw · t · sign(q̇), t in days",
            source: "ROKVISS, lessons learned, Fig. 10",
            coefficients: &[EffectParameter::new(
                "kw",
                Unit::new("Nm/day", "N/day"),
                -20.0,
                20.0,
            )],
            shows_as: "step changes with date",
            excited_by: "the same motion at one temperature on many dates",
            shown_by: Proposal::DateSweep,
            contrasts: &[Contrast::TemperatureSweep],
            confusable_with: &["temperature_coulomb"],
            varies: Some("coulomb"),
            own_signals: OwnSignals::varying(&["date"]),
            ..Row::NONE
        },
        reads: &[Signal::Velocity, Signal::Date],
        columns: |state, _, columns| columns.fill(state.days * state.sign()),
        unavailable: Facts::no_dates,
        ..StaticEffect::NONE
    },
];
