//! A gap, or a soft gear, before a load that nobody measures, in recordings of motor position and
//! torque alone.
//!
//! The truth is two inertias with stiff teeth or a spring between them, whose motor is led along a
//! motion: what its torque has to be follows from what is transmitted.

use super::recordings::noise;
use crate::{
    Dataset, Inertia, ModelSpec, RecordedSession, Term, Verdict, add, data::JointType, diagnose,
};

/// Inertia of motor and load \[kg m²\], and Coulomb and viscous friction of each.
const MOTOR: f64 = 0.3;
const LOAD: f64 = 0.6;
const COULOMB: f64 = 1.0;
const VISCOUS: f64 = 0.5;
/// Stiffness \[Nm/rad\] and damping of the teeth.
const TEETH: (f64, f64) = (2e4, 60.0);
/// Steps of the integration a sample, and time between samples \[s\].
const STEPS: u32 = 20;
const PERIOD: f64 = 1e-3;

fn friction(velocity: f64) -> f64 {
    COULOMB * (velocity / 1e-3).tanh() + VISCOUS * velocity
}

/// Position \[rad\], velocity and acceleration that the motor is led along.
pub(crate) type Motion = [f64; 3];

/// Three sines, which differ from session to session.
fn sines(session: u32, time: f64) -> Motion {
    let number = f64::from(session);
    let mut motion = [0.0; 3];
    for (amplitude, rate) in [(0.5, 0.9), (0.2, 2.3 + 0.2 * number), (0.03, 6.1)] {
        let (sine, cosine) = (rate * time + number).sin_cos();
        motion[0] += amplitude * sine;
        motion[1] += amplitude * rate * cosine;
        motion[2] -= amplitude * rate * rate * sine;
    }
    motion
}

/// Strokes of 0.9 s to and fro at four speeds, with 0.1 s to start and to stop.
pub(crate) fn strokes(session: u32, time: f64) -> Motion {
    const STROKE: f64 = 0.9;
    const RAMP: f64 = 0.1;
    let number = (time / STROKE).floor();
    let speed = [0.2, 0.9, 0.4, 0.6][(number as usize / 2 + session as usize) % 4];
    let direction = if number % 2.0 == 0.0 { 1.0 } else { -1.0 };
    let since = time - number * STROKE;
    let length = STROKE - RAMP;
    let [way, share, rate] = match since {
        t if t < RAMP => [0.5 * t * t / RAMP, t / RAMP, 1.0 / RAMP],
        t if t < length => [t - 0.5 * RAMP, 1.0, 0.0],
        t => {
            let left = STROKE - t;
            let way = length - 0.5 * left * left / RAMP;
            [way, left / RAMP, -1.0 / RAMP]
        }
    };
    let start = if direction > 0.0 { 0.0 } else { length };
    [
        speed * (start + direction * way),
        direction * speed * share,
        direction * speed * rate,
    ]
}

/// What a gap transmits, by how far and how fast the motor is ahead of the load \[Nm\].
fn teeth(gap: f64) -> impl Fn(f64, f64) -> f64 {
    move |ahead, faster| {
        let pressed = ahead - ahead.clamp(-0.5 * gap, 0.5 * gap);
        let tooth = TEETH.0 * pressed + TEETH.1 * faster;
        // Teeth push, they do not pull.
        if tooth * pressed > 0.0 { tooth } else { 0.0 }
    }
}

/// The same of a spring on which the load swings at `frequency` \[Hz\].
fn spring(frequency: f64, damping_ratio: f64) -> impl Fn(f64, f64) -> f64 {
    let omega = std::f64::consts::TAU * frequency;
    move |ahead, faster| LOAD * (omega * omega * ahead + 2.0 * damping_ratio * omega * faster)
}

/// Two sessions of 40 s, the load so far \[rad\] behind the motor at the start.
fn recorded(
    motion: impl Fn(u32, f64) -> Motion,
    behind: f64,
    transmitted: impl Fn(f64, f64) -> f64,
) -> Dataset {
    let session = |number: u32| {
        let mut noise = noise(u64::from(number) + 7);
        let mut session = RecordedSession {
            name: format!("session {number}"),
            start: f64::from(number) * 3600.0,
            period: PERIOD,
            ..RecordedSession::default()
        };
        let [q, mut speed, _] = motion(number, 0.0);
        let mut place = q - behind;
        for step in 0..40_000 * STEPS {
            let step_time = PERIOD / f64::from(STEPS);
            let [q, qd, qdd] = motion(number, f64::from(step) * step_time);
            let load = transmitted(q - place, qd - speed);
            if step % STEPS == 0 {
                let torque = MOTOR * qdd + friction(qd) + load;
                session.position.push(q + 2e-6 * noise());
                session.motor_torque.push(torque + 0.03 * noise());
            }
            speed += step_time * (load - friction(speed)) / LOAD;
            place += step_time * speed;
        }
        session
    };
    Dataset {
        sessions: (0..2).map(session).collect(),
        held_out: Vec::new(),
        joint: JointType::Revolute,
        filter: None,
    }
}

fn model() -> ModelSpec {
    ModelSpec {
        inertia: Inertia::Fit,
        gear_ratio: None,
        effects: ["coulomb", "viscous"]
            .map(|id| Term::Catalogue(id.to_owned()))
            .into(),
    }
}

/// `effect` is named first, and left in the model it leaves less than `share` of the error and has
/// the values of `expected`, each within its share.
fn is_named(data: &Dataset, effect: &str, share: f64, expected: &[(&str, f64, f64)]) {
    let found = diagnose(data, &model(), &mut |_| ()).unwrap();
    assert_eq!(found.verdict, Verdict::Missing);
    assert_eq!(found.candidates[0].effect, effect);
    let term = Term::Catalogue(effect.to_owned());
    let added = add(data, &model(), &term).unwrap();
    let left = added.held_out_after / added.held_out_before;
    assert!(left < share, "{left} of the error is left");
    for (name, expected, within) in expected {
        let found = added.parameters[*name].value;
        let apart = (found / expected - 1.0).abs();
        assert!(apart < *within, "{name} {found}, not {expected}");
    }
}

const SHARE: f64 = LOAD / (MOTOR + LOAD);

#[test]
fn a_gap_is_named_with_what_is_behind_it_and_the_rest_becomes_right() {
    let gap = 0.01;
    let data = recorded(sines, 0.5 * gap, teeth(gap));
    let expected = [
        ("inertia", MOTOR + LOAD, 0.03),
        ("b0", 2.0 * COULOMB, 0.05),
        ("b1", 2.0 * VISCOUS, 0.1),
        ("gap", gap, 0.2),
        ("inertia_share", SHARE, 0.3),
    ];
    is_named(&data, "load_backlash", 0.6, &expected);
}

#[test]
fn a_soft_gear_is_named_with_the_frequency_of_its_load() {
    for frequency in [5.0, 12.0] {
        let data = recorded(strokes, 0.0, spring(frequency, 0.04));
        let expected = [
            ("inertia", MOTOR + LOAD, 0.03),
            ("b0", 2.0 * COULOMB, 0.03),
            ("b1", 2.0 * VISCOUS, 0.06),
            ("frequency", frequency, 0.03),
            ("load_share", SHARE, 0.1),
            // Friction of the load by share of the inertia: half of it by two thirds.
            ("friction_ratio", 0.75, 0.3),
        ];
        is_named(&data, "load_elasticity", 0.4, &expected);
    }
}

#[test]
fn without_a_gap_there_is_nothing() {
    let stiff = recorded(sines, 0.0, teeth(0.0));
    let found = diagnose(&stiff, &model(), &mut |_| ()).unwrap();
    let names: Vec<&str> = found.candidates.iter().map(|own| &*own.effect).collect();
    assert_eq!((found.verdict, names), (Verdict::Complete, vec![]));
}
