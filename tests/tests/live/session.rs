//! The main job: a session runs, is recorded, sums up, and leaves nothing behind.

use std::{fs, time::Duration};

use ferntast_msgs::{sample::OperatingState, topics};
use ferntast_tests::{
    PATIENCE, Process, Session, await_enabled, messages, recording, refused, run, start, state,
    wait_for,
};

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
    let enabled = wait_for(PATIENCE, || {
        let ended = state(&session, "follower", "enable");
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

#[test]
fn a_recording_that_was_changed_is_told() {
    // The recording of one seed with the origin of another would be a lie;
    // here: a session in real time cannot be fed again byte for byte.
    let session = Session::new();
    start(&session, &["--duration", "1"])
        .wait(PATIENCE)
        .success();
    refused(&session, &["replay", "run"], &["run", "lockstep"]);
}
