//! Friction over velocity and load.

use super::facts::Facts;
use super::proposal::{Contrast, Proposal};
use super::row::{
    ConstantOf, Direction, EffectParameter, Exact, ONE, OwnSignals, Part, Row, SPEED, TORQUE, Unit,
};
use super::static_effect::{Signal, StaticEffect, logarithmic_shapes, positive};

const OVER_SPEED: OwnSignals = OwnSignals::new(&["velocity"], Direction::Opposite);
const QUADRATIC: EffectParameter =
    EffectParameter::new("b2", Unit::new("Nm s²/rad²", "N s²/m²"), -1e4, 1e4).key("b_2");
const CUBIC: EffectParameter =
    EffectParameter::new("b3", Unit::new("Nm s³/rad³", "N s³/m³"), -1e4, 1e4).key("b_3");

/// All of them.
pub(super) static EFFECTS: &[StaticEffect] = &[
    StaticEffect {
        row: Row {
            id: "coulomb",
            equation: "τ_F = b0 · sign(q̇)",
            source: "ROKVISS, lessons learned, equation (3)",
            coefficients: &[EffectParameter::new("b0", TORQUE, 0.0, 200.0).key("b_0")],
            shows_as: "step at q̇ = 0",
            excited_by: "motion in both directions",
            shown_by: Proposal::WideSpeedRange,
            contrasts: &[
                Contrast::SlowReversals,
                Contrast::WideSpeedRange,
                Contrast::LoadSteps,
            ],
            confusable_with: &["presliding_hysteresis", "stribeck"],
            part: Some(Part::Constant),
            own_signals: OVER_SPEED,
            ..Row::NONE
        },
        columns: |state, _, columns| columns.fill(state.sign()),
        ..StaticEffect::NONE
    },
    StaticEffect {
        row: Row {
            id: "load_coulomb",
            equation: "τ_F = b0T · |τ| · sign(q̇)",
            source: "ROKVISS, lessons learned, equation (3)",
            // Table 1 has one set below zero, badly excited.
            coefficients: &[EffectParameter::new("b0T", ONE, -1.0, 1.0).key("b_0T")],
            shows_as: "step that grows with load",
            excited_by: "slow motion in both directions under loads from none to full",
            shown_by: Proposal::LoadSteps,
            contrasts: &[Contrast::FastByLoad, Contrast::LoadSteps],
            confusable_with: &["torque_sensor_gain", "motor_constant"],
            part: Some(Part::ByLoad),
            own_signals: OwnSignals::new(&["load"], Direction::Opposite),
            ..Row::NONE
        },
        reads: &[Signal::Velocity, Signal::Load],
        columns: |state, _, columns| columns.fill(state.load.abs() * state.sign()),
        unavailable: Facts::no_load,
        ..StaticEffect::NONE
    },
    StaticEffect {
        row: Row {
            id: "viscous",
            equation: "τ_F = b1 · q̇",
            source: "ROKVISS, lessons learned, equation (3)",
            coefficients: &[EffectParameter::new(
                "b1",
                Unit::new("Nm s/rad", "N s/m"),
                0.0,
                5000.0,
            )
            .key("b_1")],
            shows_as: "slope over q̇",
            excited_by: "constant speeds over the whole range",
            shown_by: Proposal::WideSpeedRange,
            contrasts: &[Contrast::WideSpeedRange, Contrast::Accelerations],
            confusable_with: &["channel_delay"],
            part: Some(Part::Viscous),
            exact: &[Exact::Velocity],
            own_signals: OVER_SPEED,
            ..Row::NONE
        },
        columns: |state, _, columns| columns.fill(state.velocity),
        ..StaticEffect::NONE
    },
    StaticEffect {
        row: Row {
            id: "quadratic_viscous",
            equation: "τ_F = b2 · q̇|q̇|",
            source: "ROKVISS, lessons learned, equation (4)",
            // Below zero with space lubricant: only the sum of the viscous terms dissipates.
            coefficients: &[QUADRATIC],
            shows_as: "curvature over q̇",
            excited_by: "constant speeds over the widest range that the joint allows",
            shown_by: Proposal::WideSpeedRange,
            contrasts: &[Contrast::WideSpeedRange],
            confusable_with: &["cubic_viscous"],
            part: Some(Part::Viscous),
            own_signals: OVER_SPEED,
            ..Row::NONE
        },
        columns: |state, _, columns| columns.fill(state.velocity * state.velocity.abs()),
        ..StaticEffect::NONE
    },
    StaticEffect {
        row: Row {
            id: "cubic_viscous",
            equation: "τ_F = b3 · q̇³",
            source: "ROKVISS, lessons learned, equation (4)",
            coefficients: &[CUBIC],
            shows_as: "S over q̇",
            excited_by: "constant speeds over the widest range that the joint allows",
            shown_by: Proposal::WideSpeedRange,
            contrasts: &[Contrast::WideSpeedRange],
            confusable_with: &["quadratic_viscous"],
            part: Some(Part::Viscous),
            own_signals: OVER_SPEED,
            ..Row::NONE
        },
        columns: |state, _, columns| columns.fill(state.velocity.powi(3)),
        ..StaticEffect::NONE
    },
    StaticEffect {
        row: Row {
            id: "nonlinear_viscous",
            equation: "τ_F = b2 · q̇|q̇| + b3 · q̇³",
            source: "ROKVISS, lessons learned, the step from equation (3) to (4)",
            coefficients: &[QUADRATIC, CUBIC],
            shows_as: "S over q̇",
            excited_by: "constant speeds over the widest range that the joint allows",
            shown_by: Proposal::WideSpeedRange,
            contrasts: &[Contrast::WideSpeedRange],
            confusable_with: &["stribeck"],
            part: Some(Part::Viscous),
            contains: &[("quadratic_viscous", 1), ("cubic_viscous", 0)],
            is_sum: true,
            own_signals: OVER_SPEED,
            ..Row::NONE
        },
        columns: |state, _, columns| {
            if let [quadratic, cubic] = columns {
                *quadratic = state.velocity * state.velocity.abs();
                *cubic = state.velocity.powi(3);
            }
        },
        ..StaticEffect::NONE
    },
    StaticEffect {
        row: Row {
            id: "stribeck",
            equation: "τ_F = bs · exp(−(q̇/vs)²) · sign(q̇)",
            source: "Armstrong-Hélouvry, Dupont, Canudas de Wit 1994",
            coefficients: &[EffectParameter::new("bs", TORQUE, 0.0, 200.0)],
            shape: &[EffectParameter::new("vs", SPEED, 1e-6, 100.0)],
            shows_as: "bump near q̇ = 0",
            excited_by: "slow constant speeds in small steps, down to the slowest",
            shown_by: Proposal::WideSpeedRange,
            contrasts: &[Contrast::SlowReversals, Contrast::WideSpeedRange],
            confusable_with: &["coulomb", "presliding_hysteresis"],
            own_signals: OVER_SPEED,
            ..Row::NONE
        },
        columns: |state, shape, columns| {
            if let ([c], [vs, ..]) = (columns, shape) {
                *c = (-(state.velocity / vs).powi(2)).exp() * state.sign();
            }
        },
        shapes: |facts| logarithmic_shapes(stribeck_speeds(facts), 9),
        bounds: |facts| vec![stribeck_speeds(facts)],
        // Friction that rises towards rest; a dip there is something else.
        is_plausible: positive,
        ..StaticEffect::NONE
    },
    StaticEffect {
        row: Row {
            id: "load_stribeck",
            equation: "τ_F = bsT · |τ| · exp(−(q̇/vsT)²) · sign(q̇)",
            source: "Bittencourt, Gunnarsson 2012, static friction of an industrial robot's joint",
            coefficients: &[EffectParameter::new("bsT", ONE, 0.0, 10.0)],
            shape: &[EffectParameter::new("vsT", SPEED, 1e-6, 100.0)],
            shows_as: "bump near q̇ = 0 that grows with load",
            excited_by: "slow constant speeds in small steps under loads from none to full",
            shown_by: Proposal::LoadSteps,
            contrasts: &[
                Contrast::SlowReversals,
                Contrast::WideSpeedRange,
                Contrast::LoadSteps,
            ],
            confusable_with: &["stribeck", "load_coulomb"],
            own_signals: OwnSignals::new(&["velocity", "load"], Direction::Opposite),
            ..Row::NONE
        },
        reads: &[Signal::Velocity, Signal::Load],
        columns: |state, shape, columns| {
            if let ([c], [vs, ..]) = (columns, shape) {
                *c = (-(state.velocity / vs).powi(2)).exp() * state.load.abs() * state.sign();
            }
        },
        unavailable: Facts::no_load,
        shapes: |facts| logarithmic_shapes(stribeck_speeds(facts), 9),
        bounds: |facts| vec![stribeck_speeds(facts)],
        is_plausible: positive,
    },
    StaticEffect {
        row: Row {
            id: "asymmetric_coulomb",
            equation: "τ_F = ba",
            source: "offset by direction, as in Janot, Gautier, Brunot 2019",
            coefficients: &[EffectParameter::new("ba", TORQUE, -200.0, 200.0)],
            shows_as: "levels differ by direction",
            excited_by: "motion in both directions at two positions and without load",
            shown_by: Proposal::WidePosition,
            contrasts: &[Contrast::WidePosition],
            confusable_with: &["torque_sensor_offset", "gravity"],
            constant: Some(ConstantOf::Friction),
            exact: &[Exact::One],
            own_signals: OwnSignals::new(&["velocity", "position"], Direction::Same),
            ..Row::NONE
        },
        reads: &[],
        columns: |_, _, columns| columns.fill(1.0),
        ..StaticEffect::NONE
    },
    StaticEffect {
        row: Row {
            id: "asymmetric_viscous",
            equation: "τ_F = bav · |q̇|",
            source: "slope by direction, as in Janot, Gautier, Brunot 2019",
            coefficients: &[EffectParameter::new(
                "bav",
                Unit::new("Nm s/rad", "N s/m"),
                -5000.0,
                5000.0,
            )],
            shows_as: "slopes over q̇ differ by direction",
            excited_by: "several speeds in both directions",
            shown_by: Proposal::WideSpeedRange,
            contrasts: &[Contrast::WideSpeedRange],
            confusable_with: &["asymmetric_coulomb"],
            own_signals: OwnSignals::new(&["velocity"], Direction::Same),
            // A slope that differs by direction without a level that does is a
            // part of an asymmetry: not simpler than one cause with one number.
            freedom: Some(2),
            ..Row::NONE
        },
        columns: |state, _, columns| columns.fill(state.velocity.abs()),
        ..StaticEffect::NONE
    },
];

/// From the slowest speed seen to where the fastest shows nothing of it.
fn stribeck_speeds(facts: &Facts) -> [f64; 2] {
    let low = f64::max(0.7 * facts.speed[0], 0.01 * facts.speed[1]);
    [low, f64::max(0.4 * facts.speed[1], 2.0 * low)]
}
