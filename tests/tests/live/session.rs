//! The main job: a session runs, is recorded, sums up, and leaves nothing behind.

use std::{fs, time::Duration};

use ferntast_msgs::{sample::OperatingState, topics};
use ferntast_tests::{
    PATIENCE, Process, Session, await_enabled, messages, node, recording, refused, run, signal,
    start, state, state_of_follower, wait_for,
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

/// Who says so from the first moment on is heard as the nodes come up, before or after the
/// session arms the arm: neither the session nor the script's operator undoes it.
#[test]
fn a_stop_while_the_nodes_come_up_stays() {
    let session = Session::new();
    let process = start(&session, &[]);
    let disabled = || {
        let told = state(&session, "follower", "disable");
        told.status.success().then(|| told.json())
    };
    let told = wait_for(PATIENCE, disabled).expect("somebody answers");
    // It stood before: that it stands does not say that the word was heard.
    assert_eq!(told["reason"], "disable was asked for");
    std::thread::sleep(Duration::from_secs(4));
    assert_eq!(state_of_follower(&session), "DISABLED");
    process.interrupt();
    process.wait(PATIENCE).success();
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

/// What a machine that stalls does to a newcomer's first session.
#[test]
fn after_a_silence_the_scripts_operator_goes_on_and_the_summary_tells() {
    let session = Session::new();
    let mut process = Process::spawn(session.ferntast_here(&["session", "--no-console"]));
    process.await_stderr("nodes alive", PATIENCE);
    let told = "script's operator: resume (the arm was PAUSED: commands fell silent)";
    let went_on = (0..5).any(|_| {
        // A stall that takes the arm along, too, makes a fault of it: then once more.
        let master = node(&session, "master");
        signal(master, libc::SIGSTOP);
        std::thread::sleep(Duration::from_millis(300));
        signal(master, libc::SIGCONT);
        let enabled = || (state_of_follower(&session) == "ENABLED").then_some(());
        std::thread::sleep(Duration::from_millis(500));
        assert!(wait_for(PATIENCE, enabled).is_some(), "it does not go on");
        process.stderr().contains(told)
    });
    assert!(went_on, "{}", process.stderr());
    // Who stops the arm has it: no script arms it again.
    state(&session, "follower", "pause");
    std::thread::sleep(Duration::from_secs(3));
    assert_eq!(state_of_follower(&session), "PAUSED");
    process.interrupt();
    let ended = process.wait(PATIENCE).success();
    let line = |begin: &str| {
        let line = ended.stdout.lines().find(|line| line.starts_with(begin));
        line.unwrap_or_else(|| panic!("no {begin:?}:\n{}", ended.stdout))
    };
    let arm = line("follower");
    assert!(
        arm.contains("PAUSED") && arm.contains("(commands fell silent; send resume)"),
        "{arm}"
    );
    assert!(arm.contains("(pause was asked for)"), "{arm}");
    assert!(
        line("operator").contains("armed the arm again"),
        "{}",
        ended.stdout
    );
    // As it was before the nodes were stopped.
    assert!(!line("leader").contains("PAUSED"), "{}", ended.stdout);
}

#[test]
fn every_node_runs_alone() {
    // Arm, servo and estimator started by hand make an arm that takes commands.
    let session = Session::new();
    let alone = |name: &str| Process::spawn(session.ferntast_here(&["node", name]));
    let mut nodes: Vec<_> = [
        "arm",
        "servo",
        "estimator",
        "link_follower",
        "link_leader",
        "master",
        "gateway",
    ]
    .map(alone)
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
