//! Dynamics of an arm of seven joints (panda) beside Pinocchio's and MuJoCo's, in one run:
//! inverse dynamics, and a step of the simulated arm beside Pinocchio's forward dynamics (ABA,
//! without integration) and MuJoCo's `mj_step`, all without friction and contact:
//! `cargo bench --workspace --bench rigid_body`. Needs `.venv`, which `./tests/run` makes,
//! or a Python with `pin` and `example-robot-data` by FERNTAST_PYTHON.
//!
//! Pinocchio and MuJoCo go through a batch in loops of their own, so that Python does not
//! count. Each takes the best of five batches, one after the other.

use std::{hint::black_box, time::Instant};

use ferntast_model::{Joints, rigid_body::Vector3};
use ferntast_sim::serial_arm::{SerialArm, SerialArmParameters};
use ferntast_urdf::Robot;
use serde_json::{Value, json};

const STATES: usize = 1000;
const REPEAT: usize = 200_000;
/// Of the simulated arm [s].
const STEP: f64 = 1e-4;
const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

fn main() {
    let peer = ferntast_tests::peer("rigid_body.py");
    let listed = ferntast_tests::ask_python(&peer, &json!({}));
    let files = listed["files"].as_array().expect("files");
    let mut files = files.iter().filter_map(Value::as_str);
    let file = files.find(|file| file.ends_with("/panda.urdf"));
    let file = file.expect("panda in example-robot-data");
    let robot = Robot::read(&std::fs::read(file).expect("a file")).expect("a robot");
    let joints: Vec<String> = (1..=7).map(|joint| format!("panda_joint{joint}")).collect();
    let arm = robot.of_joints(&joints).expect("an arm");

    // Positions, velocities and accelerations spread over some periods of the sine.
    let value = |state: usize, part: usize, joint: usize| {
        2.0 * (0.37 * state as f64 + 1.1 * part as f64 + 0.7 * joint as f64).sin()
    };
    let states: Vec<[Joints<f64>; 3]> = (0..STATES)
        .map(|state| {
            [0, 1, 2]
                .map(|part| Joints::from_fn(arm.chain.count(), |joint| value(state, part, joint)))
        })
        .collect();
    let gravity = Vector3::from(GRAVITY);
    let inverse = best_of_five(|| {
        for [q, qd, qdd] in states.iter().cycle().take(REPEAT) {
            black_box(arm.chain.inverse_dynamics(black_box(q), qd, qdd, &gravity));
        }
    });
    let count = arm.chain.count();
    let parameters = SerialArmParameters {
        substep: Some(STEP),
        gravity: GRAVITY,
        ..SerialArmParameters::default()
    };
    let limits = Joints::filled(count, 100.0);
    let mut falling = SerialArm::new(&arm.chain, &limits, &parameters, 1).expect("an arm");
    let torque = Joints::filled(count, 0.0);
    let step = best_of_five(|| {
        for _ in 0..REPEAT {
            falling.advance(black_box(&torque), STEP);
        }
    });

    let list = |values: &Joints<f64>| values.to_vec();
    let asked: Vec<Value> = states
        .iter()
        .map(|[q, qd, qdd]| json!({"q": list(q), "qd": list(qd), "qdd": list(qdd)}))
        .collect();
    let told = ferntast_tests::ask_python(
        &peer,
        &json!({
            "arms": [{"file": file, "joints": joints, "tip": arm.tip, "gravity": GRAVITY,
                "states": asked}],
            "repeat": REPEAT,
        }),
    );
    let theirs = |what: &str| told["nanoseconds"][what].as_f64().expect("a number");
    println!("7 joints, nanoseconds; how many times as long ours takes");
    let tell = |what: &str, ours: f64, whose: &str, theirs: f64| {
        println!(
            "{what:<18} {ours:>6.0}   {whose:<18} {theirs:>6.0}   {:.2}",
            ours / theirs
        );
    };
    let (aba, mj_step) = (theirs("forward"), theirs("step"));
    tell(
        "inverse dynamics",
        inverse,
        "Pinocchio, RNEA",
        theirs("inverse"),
    );
    tell("step", step, "Pinocchio, ABA", aba);
    tell("step", step, "MuJoCo, mj_step", mj_step);
}

/// Of a batch of `REPEAT`, what one takes [ns].
fn best_of_five(mut batch: impl FnMut()) -> f64 {
    let mut time = || {
        let begin = Instant::now();
        batch();
        begin.elapsed().as_secs_f64() / REPEAT as f64 * 1e9
    };
    (0..5).map(|_| time()).fold(f64::INFINITY, f64::min)
}
