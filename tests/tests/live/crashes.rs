//! Nodes that die are started again; nothing recorded is lost; nothing stays behind.

use std::{thread, time::Duration};

use ferntast_tests::{
    PATIENCE, Process, Session, await_enabled, limit_files, node, rearmed, recording, run, signal,
    start, state, state_of_follower, wait_until,
};

#[test]
fn every_node_that_dies_is_started_again() {
    let session = Session::new();
    let mut process = start(&session, &[]);
    await_enabled(&session, &mut process);
    let nodes = [
        "arm",
        "servo",
        "estimator",
        "master",
        "link_leader",
        "link_follower",
        "gateway",
    ];
    for name in nodes {
        let before = node(&session, name);
        signal(before, libc::SIGKILL);
        process.await_stderr(&format!("node {name} died"), PATIENCE);
        assert!(wait_until(PATIENCE, || node(&session, name) != before));
        thread::sleep(Duration::from_millis(500));
    }
    // A busy machine takes seconds to start the gateway, which was the last.
    thread::sleep(Duration::from_secs(5));
    process.interrupt();
    let summary = process.wait(PATIENCE).success().json();
    for name in nodes {
        let told = &summary["nodes"][name];
        assert_eq!(told["restarts"], 1, "{name}: {summary:#}");
        assert_eq!(told["alive"], true, "{name}: {summary:#}");
    }
    // An arm whose servo was started again does not move by itself.
    let visited = summary["states"]["follower"]["visited"]
        .as_array()
        .expect("states");
    assert_eq!(visited.last().expect("a state"), "DISABLED", "{summary:#}");
    assert_eq!(summary["recorder"]["lost"], 0, "{summary:#}");
    assert_eq!(
        summary["recorder"]["parts"].as_array().map(Vec::len),
        Some(1)
    );
}

/// Pauses by the operator's word, out of a fault too that a stalling machine made.
fn paused(session: &Session) {
    let is_paused = || state_of_follower(session) == "PAUSED";
    assert!(wait_until(PATIENCE, || {
        rearmed(session);
        state(session, "follower", "pause");
        wait_until(Duration::from_secs(1), is_paused)
    }));
}

/// A pause lasts until an operator says otherwise, whatever is started again.
#[test]
fn a_crash_of_the_operators_end_leaves_a_paused_arm_paused() {
    let session = Session::new();
    let mut process = start(&session, &[]);
    await_enabled(&session, &mut process);
    // The operator's word, which its end of the link counts and loses when it dies.
    paused(&session);
    assert!(wait_until(PATIENCE, || {
        state(&session, "leader", "resume");
        state_of_follower(&session) == "ENABLED"
    }));
    paused(&session);
    for _ in 0..3 {
        let before = node(&session, "link_leader");
        signal(before, libc::SIGKILL);
        assert!(wait_until(PATIENCE, || node(&session, "link_leader") != before));
        thread::sleep(Duration::from_secs(3));
        // A machine that stalls may make a fault of it.
        let state = state_of_follower(&session);
        assert!(matches!(state.as_str(), "PAUSED" | "FAULT"), "{state}");
    }
    rearmed(&session);
    process.interrupt();
    process.wait(PATIENCE).success();
}

#[test]
fn a_recorder_that_dies_loses_at_most_what_it_had_not_written() {
    let session = Session::new();
    let mut process = start(&session, &[]);
    await_enabled(&session, &mut process);
    thread::sleep(Duration::from_secs(3));
    signal(node(&session, "recorder"), libc::SIGKILL);
    process.await_stderr("node recorder died", PATIENCE);
    thread::sleep(Duration::from_secs(2));
    process.interrupt();
    // What was said while no recorder ran is missing.
    let ended = process.wait(PATIENCE).failure();
    let summary = ended.json();
    let told = summary["recorder"]["faults"].to_string();
    assert!(told.contains("started again 1 times"), "{summary:#}");
    assert!(ended.stderr.contains("not whole"), "{}", ended.stderr);
    let parts = summary["recorder"]["parts"].as_array().expect("parts");
    assert_eq!(parts.len(), 2, "{summary:#}");
    let mut messages = 0;
    for part in parts {
        let part = session.folder().join(part.as_str().expect("a path"));
        let info = ferntast_bag::info(&part).unwrap_or_else(|error| panic!("{error}"));
        assert!(info.duration_s > 1.0, "{}: {info:?}", part.display());
        assert!(info.closed && info.breaks.is_empty(), "{info:?}");
        messages += info.messages;
    }
    assert_eq!(summary["recorder"]["messages"], messages);
}

#[test]
fn a_recording_that_the_disk_has_no_room_for_is_a_failure() {
    let session = Session::new();
    let mut command = session.ferntast_here(&["session", "--json", "--record", "run"]);
    // The line that says ENABLED may come five seconds after that.
    command.args(["--duration", "15", "--no-console"]);
    let mut process = Process::spawn_on_a_small_disk(command, libc::RLIM_INFINITY);
    await_enabled(&session, &mut process);
    thread::sleep(Duration::from_secs(3));
    limit_files(node(&session, "recorder"), 1 << 16).expect("a recorder");
    let ended = process.wait(PATIENCE).failure();
    let summary = ended.json();
    assert!(
        summary["recorder"]["lost"].as_u64() > Some(100),
        "{summary:#}"
    );
    let told = summary["recorder"]["faults"].to_string();
    assert!(told.contains("lost"), "{summary:#}");
    assert!(
        ended.stderr.contains("the recording is not whole"),
        "{}",
        ended.stderr
    );
    // What was written in time can be read.
    let info = ferntast_bag::info(&recording(&session)).expect("mended");
    assert!(
        info.closed && info.breaks.is_empty() && info.duration_s > 2.0,
        "{info:?}"
    );
}

#[test]
fn a_supervisor_that_dies_takes_its_nodes_along_and_can_be_started_again() {
    let session = Session::new();
    let mut process = start(&session, &[]);
    await_enabled(&session, &mut process);
    process.crash();
    drop(process);
    assert!(wait_until(PATIENCE, || session.processes().is_empty()));
    // Its recorder had the time to close the recording.
    let info = ferntast_bag::info(&recording(&session)).expect("a recording");
    assert!(info.closed && info.messages > 1000, "{info:?}");
    std::fs::rename(recording(&session), session.folder().join("before")).expect("the recording");
    start(&session, &["--duration", "1"])
        .wait(PATIENCE)
        .success();
}

#[test]
fn a_recording_that_was_cut_off_is_mended() {
    let session = Session::new();
    start(&session, &["--duration", "3"])
        .wait(PATIENCE)
        .success();
    let file = recording(&session).join("run_0.mcap");
    let whole = std::fs::read(&file).expect("the recording's file");
    let before = ferntast_bag::info(&recording(&session))
        .expect("a recording")
        .messages;
    std::fs::write(&file, &whole[..whole.len() / 2]).expect("scratch folder");

    ferntast_tests::refused(
        &session,
        &["play", "run"],
        &["run_0.mcap", "ferntast bag repair"],
    );
    run(&session, &["bag", "repair", "run", "--json"]).success();
    let after = ferntast_bag::info(&recording(&session))
        .expect("mended")
        .messages;
    assert!(after > before / 4 && after < before, "{after} of {before}");
}
