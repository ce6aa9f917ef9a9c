//! The main job: a session runs, is recorded, sums up, and leaves nothing behind.

use std::{fs, time::Duration};

use ferntast_msgs::{
    sample::{Edge, OperatingState},
    topics,
};
use ferntast_tests::{Process, Session};

use crate::support::{PATIENCE, attempts, await_enabled, messages, number, recording, run, start};

#[test]
fn a_session_runs_is_recorded_and_sums_up() {
    attempts(|| {
        let session = Session::new();
        let process = start(&session, &["--duration", "8"]);
        let ended = process.wait(PATIENCE).success();
        let summary = ended.json();

        assert!((number(&summary, "duration_s") - 8.0).abs() < 0.5);
        assert!((number(&summary, "servo.rate_hz") - 1000.0).abs() < 50.0);
        assert!(number(&summary, "servo.missed") < 800.0, "{summary:#}");
        assert!(
            (number(&summary, "link.rtt_ms") - 20.0).abs() < 2.0,
            "{summary:#}"
        );
        assert!(number(&summary, "link.loss") < 0.02);
        // In the first eight seconds the script presses on the lubricated edge.
        let force = number(&summary, "contact.peak_normal_force_N");
        assert!((10.0..80.0).contains(&force), "{force} N");
        assert_eq!(summary["contact"]["edges"][0], "lubricated");
        let felt = number(&summary, "leader.peak_force_N");
        assert!((0.05 * 10.0..0.05 * 90.0).contains(&felt), "{felt} N");
        assert_eq!(summary["states"]["follower"]["final"], "ENABLED");
        assert_eq!(summary["recording"], "run");
        assert_eq!(summary["recorder"]["lost"], 0);
        for (name, node) in summary["nodes"].as_object().expect("nodes") {
            assert_eq!(node["alive"], true, "{name}");
            assert_eq!(node["restarts"], 0, "{name}");
        }
        // A person saw lines, not a wall of log.
        assert!(ended.stderr.contains("rtt "), "{}", ended.stderr);
        assert!(ended.stderr.lines().count() < 12, "{}", ended.stderr);

        // What was recorded is what was told.
        let path = recording(&session);
        let contacts = messages(&path, topics::FOLLOWER_CONTACT_STATE);
        assert!(
            contacts
                .iter()
                .any(|own| own.message.edge == Edge::LUBRICATED)
        );
        let joints = messages(&path, topics::FOLLOWER_MEASURED_JS);
        assert!(joints.len() > 7500, "{} of 8000", joints.len());
        let backwards = joints
            .windows(2)
            .filter(|pair| pair[1].message.stamp <= pair[0].message.stamp)
            .count();
        assert_eq!(backwards, 0);
    });
}

#[test]
fn others_open_the_recording_without_help() {
    let session = Session::new();
    start(&session, &["--duration", "2"])
        .wait(PATIENCE)
        .success();
    let report = Process::spawn(session.peer("open_bag.py", &["run"]))
        .wait(PATIENCE)
        .success()
        .json();
    let interfaces = run(&session, &["interfaces", "--json"]).success().json();
    let listed = interfaces["topics"].as_array().expect("topics");
    for library in ["rosbags", "mcap"] {
        let topics = &report[library]["topics"];
        for topic in listed {
            let name = topic["name"].as_str().expect("name");
            // One lists the channels, the other what it finds messages of.
            let silent = report["rosbags"]["topics"][name]["count"] == 0;
            if library == "mcap" && silent {
                continue;
            }
            assert_eq!(topics[name]["type"], topic["type"], "{library} {name}");
        }
        let count = topics["/follower/measured_js"]["count"].as_u64();
        assert!(
            count.is_some_and(|count| count > 1500),
            "{library}: {count:?}"
        );
        let names = &topics["/follower/measured_js"]["last"]["name"];
        assert_eq!(names, &serde_json::json!(["joint_1", "joint_2"]));
    }
    // The hashes in the recording are those that rosbags computes.
    for topic in listed {
        let name = topic["name"].as_str().expect("name");
        let own = interfaces["interfaces"]
            .as_array()
            .expect("interfaces")
            .iter()
            .find(|interface| interface["name"] == topic["type"])
            .expect("the topic's interface");
        assert_eq!(
            report["rosbags"]["topics"][name]["hash"], own["hash"],
            "{name}"
        );
    }
}

#[test]
fn the_hashes_are_those_that_others_compute() {
    let session = Session::new();
    let interfaces = run(&session, &["interfaces", "--json"]).success().json();
    let path = session.folder().join("types.json");
    fs::write(&path, interfaces["interfaces"].to_string()).expect("scratch folder");
    let checked = Process::spawn(session.peer("check_hashes.py", &["types.json"]))
        .wait(PATIENCE)
        .success()
        .json();
    assert_eq!(checked["wrong"], serde_json::json!([]));
}

#[test]
fn ctrl_c_closes_the_recording_and_sums_up() {
    let session = Session::new();
    let mut process = start(&session, &[]);
    await_enabled(&session, &mut process);
    std::thread::sleep(Duration::from_secs(1));
    process.interrupt();
    let summary = process.wait(PATIENCE).success().json();
    assert_eq!(summary["recorder"]["lost"], 0);
    let info = run(&session, &["bag", "info", "run", "--json"])
        .success()
        .json();
    assert_eq!(info["messages"], summary["recorder"]["messages"]);
    // The last state of the arm while it was recorded: the master stopped first.
    let states = messages(&recording(&session), topics::FOLLOWER_OPERATING_STATE);
    let last = states.last().expect("states").message.state;
    assert!([OperatingState::ENABLED, OperatingState::PAUSED].contains(&last));
}

#[test]
fn every_node_runs_alone() {
    // Arm, servo and estimator started by hand make an arm that takes commands.
    let session = Session::new();
    let node = |name: &str| Process::spawn(session.ferntast_here(&["node", name]));
    let mut nodes: Vec<_> = [
        "arm",
        "servo",
        "estimator",
        "link_follower",
        "link_leader",
        "master",
        "gateway",
    ]
    .map(node)
    .into();
    let enabled = ferntast_tests::wait_for(PATIENCE, || {
        let ended = crate::support::state(&session, "follower", "enable");
        ended.status.success().then_some(ended)
    });
    assert_eq!(
        enabled.expect("the servo answers").json()["state"],
        "ENABLED"
    );
    assert!(nodes.iter_mut().all(Process::is_running));
    for process in nodes {
        process.interrupt();
        process.wait(PATIENCE).success();
    }
    // The last one freed what they shared: the session checks that.
}
