//! An arm in MuJoCo whose tool turns with the hand, and what pushes and turns the tool.

use std::{fs, path::Path};

use ferntast_model::rigid_body::Vector3;
use ferntast_msgs::{sample::WrenchSample, topics};
use ferntast_tests::{
    PATIENCE, Process, Session, arm_state, ask_python, await_enabled, messages, number, operated,
    peer, process_driver, recording, root, run, start,
};
use serde_json::{Value, json};

const JOINTS: [&str; 7] = [
    "panda_joint1",
    "panda_joint2",
    "panda_joint3",
    "panda_joint4",
    "panda_joint5",
    "panda_joint6",
    "panda_joint7",
];

/// A panda over a link of 20 ms, whose hand does what `script` and `more` say.
fn scenario(session: &Session, script: &str, more: &str) {
    let text = format!(
        r#"
        name = "tool"
        description = "A hand that turns."
        arm = "panda"
        seed = 1
        duration = 9.0
        start = 1111658400
        [hand]
        source = "scripted"
        [hand.scripted.script]
        phase = [{script}]
        {more}
        [link]
        channel = "rokviss_20ms"
        [law]
        kind = "position_force"
        "#
    );
    fs::write(session.folder().join("tool.toml"), text).expect("scratch");
}

/// Runs it with MuJoCo as the arm; `run` is the recording.
fn lockstep(session: &Session, options: &str) -> Value {
    let plant = process_driver("mujoco_plant.py", options);
    let arguments = [
        "lockstep",
        "tool.toml",
        "--driver",
        &plant,
        "--record",
        "run",
        "--json",
    ];
    run(session, &arguments).success().json()
}

fn turned(bag: &Path) -> Value {
    let asked = json!({
        "bag": bag, "urdf": root().join("config/arms/panda.urdf"), "joints": JOINTS, "tip": "stylus_tip",
        "from": 1.0, "to": 9.0,
    });
    ask_python(&peer("tool_turns.py"), &asked)
}

/// The hand goes to and fro and turns by up to half a radian about a slanted axis, at up to 0.8 rad/s.
#[test]
fn the_tool_turns_with_the_hand() {
    let session = Session::new();
    let script = r#"{ label = "to and fro", kind = "sine", amplitude = [0.03, 0.03, 0.02],
        frequency = 0.25, duration = 20.0 }"#;
    let turn = "[hand.scripted.turn]\namplitude = [0.3, -0.2, 0.35]\nperiod = 4.0";
    scenario(&session, script, turn);
    let told = lockstep(&session, "");
    assert_eq!(told["states"]["follower"]["final"], "ENABLED", "{told:#}");
    let turned = turned(&session.folder().join("run"));
    println!("{turned}");
    assert!(number(&turned, "turned_rad") > 0.45, "{turned}");
    assert!(number(&turned, "error_rad") < 0.005, "{turned}");
    assert!(number(&turned, "delay_s") < 0.03, "{turned}");
}

/// A hand that says nothing of how it is turned, as before: the tool stays as it is.
#[test]
fn the_tool_of_a_hand_without_an_orientation_stays() {
    let session = Session::new();
    let script = r#"{ label = "to and fro", kind = "sine", amplitude = [0.03, 0.03, 0.02],
        frequency = 0.25, duration = 20.0 }"#;
    scenario(&session, script, "");
    lockstep(&session, "");
    let turned = turned(&session.folder().join("run"));
    println!("{turned}");
    assert!(number(&turned, "turned_rad") < 0.005, "{turned}");
}

/// A stock rclpy client leads a panda in space, by where its hand is and how it is turned: to and fro,
/// then down to the table, where it feels what it presses. How fast it comes to the tool: over the gateway,
/// 10 ms of the link, and the servo.
#[test]
fn rclpy_leads_the_tool_in_space() {
    let session = Session::alone();
    let mut process = start(&session, &["--arm", "panda", "--hand", "crtk"]);
    await_enabled(&session, &mut process);
    // The table is 30 mm below the tip at home.
    let state = arm_state(&session);
    let arguments = ["--deep", "0.033", "--arm-state", &state];
    let mut operator = Process::spawn(session.peer("ros_tool.py", &arguments));
    operator.await_stderr("ready", PATIENCE);
    let sent = operated(&session, operator).success().json();
    process.interrupt();
    let summary = process.wait(PATIENCE).success().json();
    println!("{sent:#} {summary:#}");

    assert_eq!(sent["interrupted"], false);
    let force = &sent["force"];
    assert_eq!(number(force, "not_finite"), 0.0);
    // 3 mm into 20 kN/m with a servo that gives way, scaled as the law has it.
    assert!(number(force, "nonzero") > 50.0, "{sent:#} {summary:#}");
    assert!(number(force, "peak_force_N") > 0.3, "{sent:#} {summary:#}");
    let pressed = number(&summary, "contact.peak_normal_force_N");
    assert!((5.0..60.0).contains(&pressed), "{summary:#}");

    // 12 s of going to and fro, as far as the machine lets the arm follow.
    let bag = recording(&session);
    let asked = json!({
        "bag": bag, "urdf": root().join("config/arms/panda.urdf"), "joints": JOINTS, "tip": "stylus_tip",
        "from": 2.0, "to": 16.0, "live": true,
    });
    let turned = ask_python(&peer("tool_turns.py"), &asked);
    println!("{turned}");
    assert!(number(&turned, "followed_s") > 1.0, "{turned}");
    assert!(number(&turned, "turned_rad") > 0.3, "{turned}");
    assert!(number(&turned, "error_rad") < 0.05, "{turned}");
    assert!(number(&turned, "delay_s") < 0.08, "{turned}");
    // However often it was held up: hand and tool belong together as when the arm was armed.
    assert!(number(&turned, "end_error_rad") < 0.02, "{turned}");
    let spread = |positions: Vec<[f64; 3]>, axis: usize| {
        let most = positions
            .iter()
            .map(|own| own[axis])
            .fold(f64::MIN, f64::max);
        most - positions
            .iter()
            .map(|own| own[axis])
            .fold(f64::MAX, f64::min)
    };
    let tip: Vec<_> = messages(&bag, topics::FOLLOWER_MEASURED_CP)
        .iter()
        .map(|own| own.message.position)
        .collect();
    for (axis, way) in [0.06, 0.06, 0.03].into_iter().enumerate() {
        let gone = spread(tip.clone(), axis);
        assert!(gone > 0.9 * way, "axis {axis}: {gone} m");
    }
}

const REST: &str = r#"{ label = "rest", kind = "hold", duration = 20.0 }"#;

/// What is estimated of a known push on the tool from 2 s after it began: mean force \[N\] and
/// torque \[Nm\].
fn told(force: [f64; 3], turn: [f64; 3]) -> [Vector3<f64>; 2] {
    let session = Session::new();
    scenario(&session, REST, "");
    let push: Vec<String> = [force, turn].concat().iter().map(f64::to_string).collect();
    let push = push.join(",");
    lockstep(&session, &format!("--push 3,9,{push}"));
    let wrenches = messages(&session.folder().join("run"), topics::FOLLOWER_MEASURED_CF);
    let begin = wrenches.first().expect("wrenches").message.stamp;
    let late = |own: &WrenchSample| (5.0..8.5).contains(&own.stamp.seconds_since(begin));
    let late: Vec<WrenchSample> = wrenches
        .iter()
        .map(|own| own.message)
        .filter(late)
        .collect();
    assert!(late.len() > 3000);
    let count = late.len() as f64;
    let mean = |part: fn(&WrenchSample) -> [f64; 3]| {
        let sum: Vector3<f64> = late.iter().map(|own| Vector3::from(part(own))).sum();
        sum / count
    };
    [mean(|own| own.force), mean(|own| own.torque)]
}

/// The wrench is that which MuJoCo applied, with a torque and without.
#[test]
fn a_known_push_and_turn_is_told_in_six_components() {
    let [force, turn] = [[4.0, -3.0, 6.0], [0.8, -0.5, 0.6]];
    let [found, turned] = told(force, turn);
    println!("{found:?} N of {force:?}, {turned:?} Nm of {turn:?}");
    let off = (found - Vector3::from(force)).norm() / Vector3::from(force).norm();
    assert!(off < 0.05, "{off}");
    let off = (turned - Vector3::from(turn)).norm() / Vector3::from(turn).norm();
    assert!(off < 0.05, "{off}");
    let [found, turned] = told(force, [0.0; 3]);
    let off = (found - Vector3::from(force)).norm() / Vector3::from(force).norm();
    assert!(
        off < 0.05 && turned.norm() < 0.01,
        "{found:?} N, {turned:?} Nm"
    );
}
