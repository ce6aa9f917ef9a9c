//! Torque over position.

use super::facts::{Facts, JointType};
use super::proposal::{Contrast, Proposal};
use super::row::{
    ANGLE, Direction, EffectParameter, Exact, ONE, OwnSignals, Row, STIFFNESS, TORQUE, Unit,
};
use super::static_effect::{Signal, StaticEffect};

const OVER_POSITION: OwnSignals = OwnSignals::new(&["position"], Direction::Same);

const fn torque(name: &'static str) -> EffectParameter {
    EffectParameter::new(name, TORQUE, -1000.0, 1000.0)
}

const fn by_load(name: &'static str) -> EffectParameter {
    EffectParameter::new(name, ONE, -10.0, 10.0)
}

const WAVE_NUMBER: Unit = Unit::new("1/rad", "1/m");

/// Turns of the wave generator: other periods are found from the residual.
fn wave_numbers_of_the_gear(facts: &Facts) -> Vec<Vec<f64>> {
    match (facts.joint, facts.gear_ratio) {
        (JointType::Revolute, Some(ratio)) => [1.0, 2.0, 4.0]
            .into_iter()
            .map(|times| vec![times * ratio])
            .filter(|shape| shape[0] * facts.travel() > 9.0)
            .collect(),
        // Per metre of travel: the gear ratio is motor turns a screw turn,
        // whose lead is not known; only the free search applies.
        _ => Vec::new(),
    }
}

/// A few turns at least, else it is a slope; more than a few samples a turn at the slowest
/// speed, else it is aliased.
fn bounds_of_wave_numbers(facts: &Facts) -> Vec<[f64; 2]> {
    let low = 9.0 / facts.travel();
    let finest = 800.0 * std::f64::consts::TAU / facts.travel();
    let high = f64::min(1.5 / (facts.speed[0] * facts.period), finest);
    vec![[low, high.max(2.0 * low)]]
}

const RIPPLE: StaticEffect = StaticEffect {
    row: Row {
        id: "ripple",
        equation: "τ_F = a_s · sin(k q) + a_c · cos(k q)",
        source: "wave generator of a harmonic drive: k = 2N, also N and 4N, N the gear ratio",
        coefficients: &[torque("a_s"), torque("a_c")],
        shape: &[EffectParameter::new("k", WAVE_NUMBER, 1e-3, 1e6)],
        shows_as: "periodic in q",
        excited_by: "slow constant speed, so slow that the ripple is not aliased",
        shown_by: Proposal::WidePosition,
        contrasts: &[Contrast::WidePosition, Contrast::Accelerations],
        confusable_with: &["local_friction"],
        is_periodic: true,
        ..Row::NONE
    },
    reads: &[Signal::Position],
    columns: |state, shape, columns| {
        if let ([sine, cosine], [k, ..]) = (columns, shape) {
            (*sine, *cosine) = (k * state.position).sin_cos();
        }
    },
    shapes: wave_numbers_of_the_gear,
    bounds: bounds_of_wave_numbers,
    ..StaticEffect::NONE
};

const LOCAL_FRICTION: StaticEffect = StaticEffect {
    row: Row {
        id: "local_friction",
        equation: "τ_F = bl · exp(−((q − ql)/wl)²) · sign(q̇)",
        source: "a dent or a dry spot",
        coefficients: &[torque("bl")],
        shape: &[
            EffectParameter::new("ql", ANGLE, -1e3, 1e3),
            EffectParameter::new("wl", ANGLE, 1e-6, 1e3),
        ],
        shows_as: "bump at one q, sign by direction",
        excited_by: "slow motion in both directions past the spot",
        shown_by: Proposal::WidePosition,
        contrasts: &[Contrast::WidePosition],
        confusable_with: &["ripple"],
        own_signals: OwnSignals::new(&["position"], Direction::Opposite),
        ..Row::NONE
    },
    reads: &[Signal::Velocity, Signal::Position],
    columns: |state, shape, columns| {
        if let ([c], [spot, width, ..]) = (columns, shape) {
            *c = (-((state.position - spot) / width).powi(2)).exp() * state.sign();
        }
    },
    shapes: |facts| spots(facts, &[(0.03, 24), (0.06, 16), (0.12, 9)]).collect(),
    bounds: |facts| {
        let travel = facts.travel();
        vec![facts.position, [0.01 * travel, 0.25 * travel]]
    },
    ..StaticEffect::NONE
};

/// All of them.
pub(super) static EFFECTS: &[StaticEffect] = &[
    RIPPLE,
    StaticEffect {
        row: Row {
            id: "ripple_2",
            equation: "τ_F = a_s2 · sin(k2 q) + a_c2 · cos(k2 q)",
            source: "a second period beside the first: another harmonic of the wave generator, the motor's poles, a tooth",
            coefficients: &[torque("a_s2"), torque("a_c2")],
            shape: &[EffectParameter::new("k2", WAVE_NUMBER, 1e-3, 1e6)],
            another: Some("ripple"),
            ..RIPPLE.row
        },
        ..RIPPLE
    },
    StaticEffect {
        row: Row {
            id: "ripple_3",
            equation: "τ_F = a_s3 · sin(k3 q) + a_c3 · cos(k3 q)",
            source: "a third period beside the first two",
            coefficients: &[torque("a_s3"), torque("a_c3")],
            shape: &[EffectParameter::new("k3", WAVE_NUMBER, 1e-3, 1e6)],
            another: Some("ripple_2"),
            ..RIPPLE.row
        },
        ..RIPPLE
    },
    StaticEffect {
        row: Row {
            id: "load_ripple",
            equation: "τ_F = τ · (a_sT · sin(k q) + a_cT · cos(k q))",
            source: "gain of a harmonic drive or of the torque sensor on it over the wave generator's turn: k = 2N, also N and 4N",
            coefficients: &[by_load("a_sT"), by_load("a_cT")],
            shape: &[EffectParameter::new("kaT", WAVE_NUMBER, 1e-3, 1e6)],
            shows_as: "periodic in q, and the higher the larger the load",
            excited_by: "slow constant speed under several loads, so slow that the ripple is not aliased",
            shown_by: Proposal::LoadSteps,
            contrasts: &[Contrast::LoadSteps],
            confusable_with: &["ripple"],
            is_periodic: true,
            own_signals: OwnSignals::new(&["load"], Direction::Same),
            ..Row::NONE
        },
        reads: &[Signal::Position, Signal::Load],
        columns: |state, shape, columns| {
            if let ([sine, cosine], [k, ..]) = (columns, shape) {
                let (of_sine, of_cosine) = (k * state.position).sin_cos();
                (*sine, *cosine) = (state.load * of_sine, state.load * of_cosine);
            }
        },
        unavailable: Facts::no_load,
        shapes: wave_numbers_of_the_gear,
        bounds: bounds_of_wave_numbers,
        ..StaticEffect::NONE
    },
    LOCAL_FRICTION,
    StaticEffect {
        row: Row {
            id: "local_friction_2",
            equation: "τ_F = bl2 · exp(−((q − ql2)/wl2)²) · sign(q̇)",
            source: "a second dent or dry spot beside the first",
            coefficients: &[torque("bl2")],
            shape: &[
                EffectParameter::new("ql2", ANGLE, -1e3, 1e3),
                EffectParameter::new("wl2", ANGLE, 1e-6, 1e3),
            ],
            another: Some("local_friction"),
            ..LOCAL_FRICTION.row
        },
        ..LOCAL_FRICTION
    },
    StaticEffect {
        row: Row {
            id: "gravity",
            equation: "τ = g_s · sin q + g_c · cos q = g · sin(q + φ)",
            source: "rigid body",
            coefficients: &[torque("g_s"), torque("g_c")],
            shows_as: "over q, whatever the sign of q̇",
            excited_by: "slow motion over the widest arc that the joint allows",
            shown_by: Proposal::WidePosition,
            contrasts: &[
                Contrast::FastByWeight,
                Contrast::WidePosition,
                Contrast::LoadSteps,
            ],
            confusable_with: &["cable_spring"],
            is_load: true,
            own_signals: OVER_POSITION,
            ..Row::NONE
        },
        reads: &[Signal::Position],
        columns: |state, _, columns| {
            if let [sine, cosine] = columns {
                (*sine, *cosine) = state.position.sin_cos();
            }
        },
        unavailable: |facts| {
            (facts.joint == JointType::Prismatic).then(|| {
                "on a prismatic joint a weight is a constant: asymmetric_coulomb".to_owned()
            })
        },
        ..StaticEffect::NONE
    },
    StaticEffect {
        row: Row {
            id: "cable_spring",
            equation: "τ = kc · (q − q0) = kc · q + k0",
            source: "Hooke",
            coefficients: &[
                EffectParameter::new("kc", STIFFNESS, -1e5, 1e5),
                torque("k0"),
            ],
            shows_as: "straight line over q, whatever the sign of q̇",
            excited_by: "slow motion over the whole range of positions without load",
            shown_by: Proposal::WidePosition,
            contrasts: &[
                Contrast::FastBySpring,
                Contrast::WidePosition,
                Contrast::LoadSteps,
            ],
            confusable_with: &["gravity", "torque_sensor_gain"],
            contains: &[("asymmetric_coulomb", 0), ("torque_sensor_offset", 0)],
            exact: &[Exact::Position, Exact::One],
            is_load: true,
            own_signals: OVER_POSITION,
            ..Row::NONE
        },
        reads: &[Signal::Position],
        columns: |state, _, columns| {
            if let [slope, level] = columns {
                *slope = state.position;
                *level = 1.0;
            }
        },
        ..StaticEffect::NONE
    },
];

/// Middles and widths \[rad\] of spots of some widths, as shares of the travel,
/// and how many of each.
pub(super) fn spots<'a>(
    facts: &'a Facts,
    widths: &'a [(f64, u32)],
) -> impl Iterator<Item = Vec<f64>> + 'a {
    let range = facts.travel();
    widths.iter().flat_map(move |(width, count)| {
        (0..*count).map(move |i| {
            let share = (f64::from(i) + 0.5) / f64::from(*count);
            vec![facts.position[0] + share * range, width * range]
        })
    })
}
