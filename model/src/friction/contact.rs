//! Friction of a tip in contact: the load is F_N, the position the place along
//! the contour.

use super::facts::{Facts, Subject};
use super::place::spots;
use super::proposal::{Contrast, Proposal};
use super::row::{
    ANGLE, DAY, Direction, EffectParameter, Exact, ONE, OwnSignals, Part, Row, SPEED, Unit,
};
use super::static_effect::{Signal, StaticEffect, logarithmic_shapes, positive};

const NONE: Row = Row {
    of: Subject::Contact,
    ..Row::NONE
};
const OVER_SPEED: OwnSignals = OwnSignals::new(&["tip_velocity"], Direction::Opposite);

/// All of them.
pub(super) static EFFECTS: &[StaticEffect] = &[
    StaticEffect {
        row: Row {
            id: "contact_coulomb",
            equation: "F_T = b0T · |F_N| · sign(ṙ)",
            source: "ROKVISS, lessons learned, equation (6)",
            coefficients: &[EffectParameter::new("b0T", ONE, 0.0, 10.0)],
            shows_as: "step at ṙ = 0 that grows with the normal force",
            excited_by: "sliding in both directions at several normal forces",
            shown_by: Proposal::ContactForces,
            contrasts: &[
                Contrast::ContactDates,
                Contrast::ContactSpeeds,
                Contrast::ContactForces,
                Contrast::ContactSweep,
            ],
            confusable_with: &["contact_viscous"],
            part: Some(Part::ByLoad),
            own_signals: OwnSignals::new(&["normal_force"], Direction::Opposite),
            ..NONE
        },
        reads: &[Signal::Velocity, Signal::Load],
        columns: |state, _, columns| columns.fill(state.load.abs() * state.sign()),
        ..StaticEffect::NONE
    },
    StaticEffect {
        row: Row {
            id: "contact_viscous",
            equation: "F_T = c · ṙ",
            source: "Newtonian film between tip and contour",
            coefficients: &[EffectParameter::new("c", Unit::same("N s/m"), 0.0, 1e5)],
            shows_as: "slope over tip velocity",
            excited_by: "sliding at many speeds; at one speed it is Coulomb friction",
            shown_by: Proposal::ContactSpeeds,
            contrasts: &[Contrast::ContactSpeeds, Contrast::ContactForces],
            confusable_with: &["contact_coulomb"],
            part: Some(Part::Viscous),
            exact: &[Exact::Velocity],
            own_signals: OVER_SPEED,
            ..NONE
        },
        columns: |state, _, columns| columns.fill(state.velocity),
        ..StaticEffect::NONE
    },
    StaticEffect {
        row: Row {
            id: "contact_stribeck",
            equation: "F_T = bsT · exp(−(ṙ/vs)²) · |F_N| · sign(ṙ)",
            source: "Armstrong-Hélouvry, Dupont, Canudas de Wit 1994",
            coefficients: &[EffectParameter::new("bsT", ONE, 0.0, 10.0)],
            shape: &[EffectParameter::new("vs", SPEED, 1e-6, 100.0)],
            shows_as: "bump near rest",
            excited_by: "slow constant speeds in small steps, down to the slowest",
            shown_by: Proposal::ContactSpeeds,
            contrasts: &[
                Contrast::ContactTurns,
                Contrast::ContactSpeeds,
                Contrast::ContactForces,
                Contrast::ContactSweep,
            ],
            confusable_with: &["contact_compliance"],
            own_signals: OVER_SPEED,
            ..NONE
        },
        reads: &[Signal::Velocity, Signal::Load],
        columns: |state, shape, columns| {
            if let ([c], [vs, ..]) = (columns, shape) {
                *c = (-(state.velocity / vs).powi(2)).exp() * state.load.abs() * state.sign();
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
            id: "contact_spot",
            equation: "F_T = bl · exp(−(|r − rl|/wl)^n) · |F_N| · sign(ṙ)",
            source: "a scratch, a stain of lubricant",
            coefficients: &[EffectParameter::new("bl", ONE, -10.0, 10.0)],
            shape: &[
                EffectParameter::new("rl", ANGLE, -1e3, 1e3),
                EffectParameter::new("wl", ANGLE, 1e-6, 1e3),
                EffectParameter::new("n", ONE, 1.0, 20.0),
            ],
            shows_as: "bump over place, sign by direction",
            excited_by: "sliding in both directions over the whole contour",
            shown_by: Proposal::ContactSweep,
            contrasts: &[Contrast::ContactDates, Contrast::ContactSweep],
            confusable_with: &["contact_coulomb"],
            own_signals: OwnSignals::new(&["place"], Direction::Opposite),
            ..NONE
        },
        reads: &[Signal::Velocity, Signal::Position, Signal::Load],
        columns: |state, shape, columns| {
            if let ([c], [place, width, evenness, ..]) = (columns, shape) {
                let off = (state.position - place).abs() / width;
                *c = (-off.powf(*evenness)).exp() * state.load.abs() * state.sign();
            }
        },
        shapes: |facts| {
            let spots = spots(facts, &[(0.03, 24), (0.06, 16), (0.12, 9), (0.2, 6)]);
            spots.map(|spot| [spot, vec![2.5]].concat()).collect()
        },
        bounds: |facts| {
            vec![
                facts.position,
                [0.01 * facts.travel(), 0.3 * facts.travel()],
                // From a bump to a stretch with sharp ends.
                [1.5, 8.0],
            ]
        },
        ..StaticEffect::NONE
    },
    StaticEffect {
        row: Row {
            id: "contact_wear",
            equation: "F_T = bw · (1 − exp(−t/tw)) · |F_N| · sign(ṙ), t in days",
            source: "ROKVISS, lessons learned, Fig. 17: the lubricated surface slowly nears the bare one",
            coefficients: &[EffectParameter::new("bw", ONE, -10.0, 10.0)],
            shape: &[EffectParameter::new("tw", DAY, 1e-3, 1e5)],
            shows_as: "step at ṙ = 0 changes with date",
            excited_by: "the same sliding on many dates",
            shown_by: Proposal::ContactDates,
            contrasts: &[Contrast::ContactDates],
            confusable_with: &["contact_coulomb"],
            varies: Some("contact_coulomb"),
            own_signals: OwnSignals::varying(&["date"]),
            ..NONE
        },
        reads: &[Signal::Velocity, Signal::Load, Signal::Date],
        columns: |state, shape, columns| {
            if let ([c], [days, ..]) = (columns, shape) {
                *c = (1.0 - (-state.days / days).exp()) * state.load.abs() * state.sign();
            }
        },
        unavailable: Facts::no_dates,
        shapes: |facts| logarithmic_shapes(wear_times(facts), 7),
        bounds: |facts| vec![wear_times(facts)],
        ..StaticEffect::NONE
    },
];

fn stribeck_speeds(facts: &Facts) -> [f64; 2] {
    [0.02 * facts.speed[1], 0.5 * facts.speed[1]]
}

/// From all of it between the first two sessions to a straight line \[days\].
fn wear_times(facts: &Facts) -> [f64; 2] {
    [0.02 * facts.days, 5.0 * facts.days]
}
