//! A shoulder behind a soft gear, on which the links swing after each stroke: the elbow feels it.
//!
//! The motors are led along strokes, and the shoulder's link is integrated: what its gear transmits is
//! what its motor feels, and what the elbow takes follows from how the links really move.

use super::*;
use crate::tests::unmeasured_load::strokes;

/// Frequency of the links, at their mean inertia \[Hz\], and its damping ratio.
const FREQUENCY: f64 = 6.0;
const DAMPING_RATIO: f64 = 0.04;
/// Steps of the integration a sample.
const STEPS: u32 = 20;
const PERIOD: f64 = 0.004;
const SAMPLES: u32 = 7500;

/// Motors' positions, velocities and accelerations, at rest at the start.
fn motors(session: u32, time: f64) -> State {
    let after = |pause: f64, session| match time > pause {
        true => strokes(session, time - pause),
        false => [0.0; 3],
    };
    let [shoulder, elbow] = [after(0.5, session), after(0.87, session + 1)];
    let of = |order: usize| [shoulder[order], 0.8 * elbow[order]];
    let [q, qd, qdd] = [0, 1, 2].map(of);
    State {
        q: [q[0] + 0.3, q[1] + 0.5],
        qd,
        qdd,
    }
}

/// Inertia that the shoulder turns \[kg m²\].
fn turned(q: [f64; 2]) -> f64 {
    let torque = |acceleration| {
        let s = State {
            q,
            qd: [0.0; 2],
            qdd: [acceleration, 0.0],
        };
        links(&s, &[FOREARM], GRAVITY)[0]
    };
    torque(1.0) - torque(0.0)
}

fn recording() -> ArmDataset {
    let times = || (0..SAMPLES).map(|at| PERIOD * f64::from(at));
    let all = (0..2).flat_map(|session| times().map(move |time| turned(motors(session, time).q)));
    let mean = all.sum::<f64>() / f64::from(2 * SAMPLES);
    let omega = std::f64::consts::TAU * FREQUENCY;
    let (stiffness, damping) = (mean * omega * omega, 2.0 * DAMPING_RATIO * mean * omega);
    let session = |number: u32| {
        let mut noise = noise(u64::from(number) + 21);
        let mut session = empty_session(number, PERIOD);
        let start = motors(number, 0.0);
        let mut place = start.q[0] - links(&start, &[FOREARM], GRAVITY)[0] / stiffness;
        let mut speed = start.qd[0];
        let step = PERIOD / f64::from(STEPS);
        for number_of_step in 0..SAMPLES * STEPS {
            let motor = motors(number, step * f64::from(number_of_step));
            let gear = stiffness * (motor.q[0] - place) + damping * (motor.qd[0] - speed);
            let mut link = State {
                q: [place, motor.q[1]],
                qd: [speed, motor.qd[1]],
                qdd: [0.0, motor.qdd[1]],
            };
            let acceleration = (gear - links(&link, &[FOREARM], GRAVITY)[0]) / turned(link.q);
            link.qdd[0] = acceleration;
            if number_of_step % STEPS == 0 {
                let load = [gear, links(&link, &[FOREARM], GRAVITY)[1]];
                measure(&mut session, &motor, load, &mut noise);
            }
            speed += step * acceleration;
            place += step * speed;
        }
        session
    };
    dataset((0..2).map(session))
}

#[test]
fn a_soft_gear_is_named_in_its_joint_alone_and_what_the_others_feel_of_it_is_known_then() {
    let dataset = recording();
    let told = ask(&dataset, &PLAIN);
    let names: Vec<String> = told
        .candidates
        .iter()
        .map(|own| own.term().to_string())
        .collect();
    assert_eq!(names, ["load_elasticity@shoulder"]);
    let mut joints = told.joints.values();
    assert!(joints.all(|own| own.verdict == Verdict::Missing));

    let term = told.candidates[0].term();
    let added = add(&dataset, &model(&PLAIN), &term).unwrap();
    assert!(added.lowers_error);
    let left = added.held_out_after / added.held_out_before;
    assert!(left < 0.1, "{left} of the error is left");
    for (name, expected, within) in [
        ("frequency@shoulder", FREQUENCY, 0.01),
        ("damping_ratio@shoulder", DAMPING_RATIO, 0.1),
        ("load_share@shoulder", 1.0, 0.02),
        ("b0@elbow", 0.4, 0.02),
    ] {
        let found = added.parameters[name].value;
        assert!((found / expected - 1.0).abs() < within, "{name} {found}");
    }

    let error = |effects: &[&str]| {
        compare(&dataset, &model(effects)).unwrap().joints["elbow"]
            .rms
            .held_out
    };
    let more = [&PLAIN[..], &["load_elasticity@shoulder"]].concat();
    let (before, after) = (error(&PLAIN), error(&more));
    // White noise of 0.03 Nm through the filter on columns.
    assert!(
        after > 0.005 && after < 0.02 && after < 0.2 * before,
        "{before} {after}"
    );
}
