//! A recording goes back on the topics, with its timing, for any ROS 2 client.

use std::{thread, time::Duration};

use ferntast_tests::{Machine, PATIENCE, Process, Session, number, run};

fn record(session: &Session, seconds: &str) {
    let arguments = ["lockstep", "--duration", seconds, "--record", "run"];
    run(session, &arguments).success();
}

fn play(session: &Session, arguments: &[&str]) -> Process {
    let mut command = session.ferntast(&["play", "run", "--json"]);
    command.args(["--session", session.name()]).args(arguments);
    Process::spawn(command)
}

fn count(session: &Session, topic: &str, kind: &str, seconds: &str) -> Process {
    let arguments = [topic, kind, "--seconds", seconds, "--from-first"];
    let mut counter = Process::spawn(session.peer("count_messages.py", &arguments));
    counter.await_stderr("ready", PATIENCE);
    counter
}

#[test]
fn a_ros_client_gets_it_with_its_timing() {
    let machine = Machine::alone();
    let session = Session::new();
    record(&session, "6");
    machine.undisturbed(|| {
        let counter = count(
            &session,
            "/follower/measured_js",
            "sensor_msgs/msg/JointState",
            "4",
        );
        let played = play(&session, &[]).wait(PATIENCE).success().json();
        let counted = counter.wait(PATIENCE).success().json();
        assert!(
            (number(&played, "played_s") - 6.0).abs() < 0.5,
            "{played:#}"
        );
        // The gateway's rate on ROS 2 is 250 Hz; stamps are those of the recording.
        let rate = number(&counted, "rate_hz");
        assert!((230.0..=255.0).contains(&rate), "{counted:#}");
        assert!(
            (230.0..=255.0).contains(&number(&counted, "stamp_rate_hz")),
            "{counted:#}"
        );
        assert_eq!(number(&counted, "stamps_back"), 0.0);
        let year_2005 = 1_111_658_400e9;
        assert!(
            (number(&counted, "first_stamp_ns") - year_2005).abs() < 10e9,
            "{counted:#}"
        );
    });
}

#[test]
fn twice_as_fast_is_twice_as_fast() {
    let machine = Machine::alone();
    let session = Session::new();
    record(&session, "6");
    machine.undisturbed(|| {
        let counter = count(
            &session,
            "/follower/measured_js",
            "sensor_msgs/msg/JointState",
            "2",
        );
        let played = play(&session, &["--rate", "2"])
            .wait(PATIENCE)
            .success()
            .json();
        let counted = counter.wait(PATIENCE).success().json();
        assert!(
            (number(&played, "played_s") - 3.0).abs() < 0.4,
            "{played:#}"
        );
        let ratio = number(&counted, "stamp_rate_hz") / number(&counted, "rate_hz");
        assert!((0.4..0.6).contains(&ratio), "{counted:#}");
    });
}

#[test]
fn a_loop_goes_on_until_ctrl_c() {
    let _machine = Machine::alone();
    let session = Session::new();
    record(&session, "1");
    let process = play(&session, &["--loop"]);
    thread::sleep(Duration::from_secs(5));
    process.interrupt();
    let played = process.wait(PATIENCE).success().json();
    assert!(number(&played, "played_s") > 2.5, "{played:#}");
}

#[test]
fn a_live_estimator_computes_its_forces_anew() {
    let _machine = Machine::alone();
    let session = Session::new();
    record(&session, "6");
    let counter = count(
        &session,
        "/follower/measured_cf",
        "geometry_msgs/msg/WrenchStamped",
        "4",
    );
    let played = play(&session, &["--estimate"])
        .wait(PATIENCE)
        .success()
        .json();
    assert_eq!(played["estimated"], true);
    let counted = counter.wait(PATIENCE).success().json();
    assert!(number(&counted, "received") > 500.0, "{counted:#}");
}
