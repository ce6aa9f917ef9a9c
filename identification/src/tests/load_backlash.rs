//! A gap before a load that nobody measures, in recordings of motor position and torque alone.
//!
//! The truth is two inertias with stiff teeth between them, whose motor is led along sines: what
//! its torque has to be follows from what the teeth transmit.

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

/// Two sessions of 40 s with a gap of that width \[rad\].
fn recorded(gap: f64) -> Dataset {
    let session = |number: u32| {
        let mut noise = noise(u64::from(number) + 7);
        let mut session = RecordedSession {
            name: format!("session {number}"),
            start: f64::from(number) * 3600.0,
            period: PERIOD,
            ..RecordedSession::default()
        };
        let (mut place, mut speed) = (-0.5 * gap, 0.0);
        for step in 0..40_000 * STEPS {
            let step_time = PERIOD / f64::from(STEPS);
            let t = f64::from(step) * step_time;
            let (mut q, mut qd, mut qdd) = (0.0, 0.0, 0.0);
            for (amplitude, rate) in [
                (0.5, 0.9),
                (0.2, 2.3 + 0.2 * f64::from(number)),
                (0.03, 6.1),
            ] {
                let (sine, cosine) = (rate * t + f64::from(number)).sin_cos();
                q += amplitude * sine;
                qd += amplitude * rate * cosine;
                qdd -= amplitude * rate * rate * sine;
            }
            if step == 0 {
                (place, speed) = (q - 0.5 * gap, qd);
            }
            let ahead = q - place;
            let pressed = ahead - ahead.clamp(-0.5 * gap, 0.5 * gap);
            let tooth = TEETH.0 * pressed + TEETH.1 * (qd - speed);
            // Teeth push, they do not pull.
            let tooth = if tooth * pressed > 0.0 { tooth } else { 0.0 };
            if step % STEPS == 0 {
                let torque = MOTOR * qdd + friction(qd) + tooth;
                session.position.push(q + 2e-6 * noise());
                session.motor_torque.push(torque + 0.03 * noise());
            }
            speed += step_time * (tooth - friction(speed)) / LOAD;
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

#[test]
fn a_gap_is_named_with_what_is_behind_it_and_the_rest_becomes_right() {
    let gap = 0.01;
    let data = recorded(gap);
    let found = diagnose(&data, &model(), &mut |_| ()).unwrap();
    assert_eq!(found.verdict, Verdict::Missing, "{gap}");
    assert_eq!(found.candidates[0].effect, "load_backlash", "{gap}");
    let term = Term::Catalogue("load_backlash".to_owned());
    let added = add(&data, &model(), &term).unwrap();
    let left = added.held_out_after / added.held_out_before;
    assert!(left < 0.6, "{gap}: {left} of the error is left");
    let value = |name: &str| added.parameters[name].value;
    let near = |name: &str, expected: f64, share: f64| {
        let found = value(name);
        let apart = (found / expected - 1.0).abs();
        assert!(apart < share, "{gap}: {name} {found}, not {expected}");
    };
    near("inertia", MOTOR + LOAD, 0.03);
    near("b0", 2.0 * COULOMB, 0.05);
    near("b1", 2.0 * VISCOUS, 0.1);
    near("gap", gap, 0.2);
    near("inertia_share", LOAD / (MOTOR + LOAD), 0.3);
}

#[test]
fn without_a_gap_there_is_nothing() {
    let found = diagnose(&recorded(0.0), &model(), &mut |_| ()).unwrap();
    let names: Vec<&str> = found.candidates.iter().map(|own| &*own.effect).collect();
    assert_eq!((found.verdict, names), (Verdict::Complete, vec![]));
}
