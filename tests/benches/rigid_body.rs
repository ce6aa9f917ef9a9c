//! Inverse dynamics of an arm of seven joints (panda) beside Pinocchio's, in one run:
//! `cargo bench --workspace --bench rigid_body`. Needs `.venv`, which `./tests/run` makes,
//! or a Python with `pin` and `example-robot-data` by FERNTAST_PYTHON.
//!
//! Pinocchio goes through a batch of states in a loop of its own, so that Python does not
//! count. Both take the best of five batches, one after the other.

use std::{hint::black_box, time::Instant};

use ferntast_model::{Joints, rigid_body::Vector3};
use ferntast_urdf::Robot;
use serde_json::{Value, json};

const STATES: usize = 1000;
const REPEAT: usize = 200_000;
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
    let batch = || {
        let begin = Instant::now();
        for [q, qd, qdd] in states.iter().cycle().take(REPEAT) {
            black_box(arm.chain.inverse_dynamics(black_box(q), qd, qdd, &gravity));
        }
        begin.elapsed().as_secs_f64() / REPEAT as f64 * 1e9
    };
    let ours = (0..5).map(|_| batch()).fold(f64::INFINITY, f64::min);

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
    let theirs = told["nanoseconds"].as_f64().expect("a number");
    println!(
        "inverse dynamics of 7 joints: {ours:.0} ns, {:.2} million a second",
        1e3 / ours
    );
    println!(
        "Pinocchio: {theirs:.0} ns; ours takes {:.2} times as long",
        ours / theirs
    );
}
