//! An arm that others drive over ROS 2: MuJoCo in real time in a stock rclpy node.

use std::{fs, thread, time::Duration};

use ferntast_tests::{PATIENCE, Process, Session, number, root, run};
use serde_json::Value;

/// The shipped panda in the session's folder, with the patience that a busy machine asks for of an
/// arm whose simulation is a program in Python.
fn patient_arm(session: &Session) -> String {
    let shipped = root().join("config/arms");
    let copy = |name: &str| fs::read_to_string(shipped.join(name)).expect("a shipped arm");
    let patience = "\n[servo]\nmeasurement_watchdog = 0.1\n\n[driver.ros2]\nlongest_silence = 0.1\n\
        longest_delay = 0.1\nleast_rate = 20.0\n";
    let write = |name: &str, text: String| {
        fs::write(session.folder().join(name), text).expect("the session's folder");
    };
    write("panda.urdf", copy("panda.urdf"));
    write("patient.toml", copy("panda.toml") + patience);
    "patient.toml".to_owned()
}

fn robot(session: &Session, arguments: &[&str]) -> Process {
    let arm = root().join("config/arms/panda.toml");
    let arm = arm.to_str().expect("UTF-8");
    let all = [&["--arm", arm], arguments].concat();
    let mut robot = Process::spawn(session.peer("mujoco_ros_arm.py", &all));
    robot.await_stderr("ready", PATIENCE);
    robot
}

fn ended(robot: Process) -> Value {
    robot.interrupt();
    robot.wait(PATIENCE).success().json()
}

fn check(session: &Session, arm: &str) -> (Option<i32>, Value) {
    let arguments = [
        "arm",
        "check",
        "--arm",
        arm,
        "--driver",
        "ros2",
        "--seconds",
        "2",
        "--json",
    ];
    let ended = run(session, &arguments);
    (ended.status.code(), ended.json())
}

fn findings(report: &Value) -> Vec<(&str, &str, &str)> {
    let findings = report["findings"].as_array().expect("findings").iter();
    let told = findings.map(|own| {
        let text = |key: &str| own[key].as_str().unwrap_or_default();
        (text("severity"), text("what"), text("words"))
    });
    told.collect()
}

/// Looked at, the robot stands; and what is wrong with a bad one is told in words.
#[test]
fn a_robot_is_checked_without_being_moved() {
    let session = Session::new();
    let arm = patient_arm(&session);
    let good = robot(&session, &[]);
    let (code, report) = check(&session, &arm);
    let moved = ended(good);
    assert_eq!(code, Some(0), "{report:#}");
    assert_eq!(moved["commands"], 0);
    assert!(number(&report, "rate_hz") > 100.0);
    assert_eq!(report["joints"].as_array().map(Vec::len), Some(7));
    for (spoil, words) in [
        ("names", "lacks joint panda_joint1"),
        ("degrees", "degrees?"),
        ("sign", "the sign of the torque is wrong"),
    ] {
        let bad = robot(&session, &["--spoil", spoil]);
        let (code, report) = check(&session, &arm);
        ended(bad);
        assert_eq!(code, Some(1), "{spoil}: {report:#}");
        let told = findings(&report);
        let wrong = told
            .iter()
            .any(|own| own.0 == "wrong" && own.2.contains(words));
        assert!(wrong, "{spoil}: {told:#?}");
    }
}

/// A robot that falls silent in the middle: the arm is a fault in words, and the robot's brakes hold.
#[test]
fn a_robot_that_falls_silent_stops_the_arm() {
    let session = Session::alone();
    let arm = patient_arm(&session);
    let robot = robot(&session, &["--spoil", "silent", "--spoil-after", "12"]);
    let mut command = session.ferntast_here(&["session", "--json", "--no-console", "--no-rearm"]);
    command.args(["--arm", &arm, "--driver", "ros2"]);
    let mut process = Process::spawn(command);
    process.await_stderr("is silent for", PATIENCE);
    thread::sleep(Duration::from_millis(500));
    process.interrupt();
    let summary = process.wait(PATIENCE).success().json();
    ended(robot);
    assert_eq!(
        summary["states"]["follower"]["final"], "FAULT",
        "{summary:#}"
    );
    let faults = summary["nodes"]["arm"]["faults"].to_string();
    assert!(faults.contains("measurement silent"), "{faults}");
}

#[test]
fn what_cannot_be_is_refused_before_anything_is_moved() {
    let session = Session::new();
    for (arguments, words) in [
        (
            vec!["lockstep", "--driver", "ros2", "--arm", "panda"],
            "virtual time",
        ),
        (
            vec!["arm", "check", "--driver", "ros2:speed=3", "--arm", "panda"],
            "unknown field",
        ),
        (
            vec!["arm", "check", "--move", "--arm", "panda"],
            "a person who holds a key",
        ),
    ] {
        ferntast_tests::refused(&session, &arguments, &[words]);
    }
}

/// Behind a terminal with somebody who holds the key, lets go of it, and holds it again: both joints
/// of the simulated arm go out and back.
#[test]
fn a_held_key_moves_the_arm_and_letting_go_stops_it() {
    let session = Session::new();
    let ferntast = ferntast_tests::ferntast();
    let program = ferntast.to_str().expect("UTF-8");
    let arguments = [
        "--hold", "3", "--", program, "arm", "check", "--move", "--json",
    ];
    let told = Process::spawn(session.peer("hold_key.py", &arguments));
    let told = told.wait(PATIENCE).success().json();
    assert_eq!(told["terminal_restored"], true);
    let report: Value = serde_json::from_str(told["stdout"].as_str().expect("text"))
        .unwrap_or_else(|error| panic!("{error}: {told:#}"));
    assert_eq!(told["exit_code"], 0, "{report:#}");
    let moved = &report["moved"];
    assert_eq!(moved["joints"], serde_json::json!(["joint_1", "joint_2"]));
    let stops = moved["stopped_ms"].as_array().expect("stops");
    assert!(!stops.is_empty(), "{moved:#}");
    let words = told["stderr"].as_str().expect("text");
    for word in [
        "MOVE",
        "moving joint_1",
        "released: it stands",
        "the drives are off",
    ] {
        assert!(words.contains(word), "{word:?} in {words}");
    }
}
