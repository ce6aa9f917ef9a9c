//! Bad input: one message that names what, where and how to mend it; nothing moves.

use std::{fs, net::TcpListener, os::unix::process::CommandExt};

use ferntast_tests::{Process, Session, root};

use crate::support::{PATIENCE, await_enabled, refused, start};

/// A scenario in the session's folder: the shipped one with `old` replaced by `new`.
fn scenario(session: &Session, old: &str, new: &str) {
    let shipped = root().join("config/scenarios/rokviss.toml");
    let text = fs::read_to_string(shipped).expect("the shipped scenario");
    assert!(text.contains(old), "{old}");
    fs::write(
        session.folder().join("own.toml"),
        text.replacen(old, new, 1),
    )
    .expect("scratch");
}

#[test]
fn configuration_that_is_wrong() {
    let session = Session::new();
    let cases = [
        ("seed = 1", "seed = 1\nsede = 2", vec!["own.toml", "sede"]),
        ("seed = 1", "seed = -1", vec!["own.toml", "seed"]),
        (
            "stiffness = 1000.0",
            "stiffness = -5.0",
            vec!["own.toml", "hand.scripted.impedance.stiffness", "-5"],
        ),
        (
            "stiffness = 1000.0",
            "stiffness = nan",
            vec!["own.toml", "hand.scripted.impedance.stiffness", "NaN"],
        ),
        (
            "channel = \"rokviss_20ms\"",
            "channel = \"rokvis\"",
            vec!["rokvis", "rokviss_20ms"],
        ),
        (
            "arm = \"rokviss\"",
            "arm = \"missing.toml\"",
            vec!["missing.toml"],
        ),
        (
            "kind = \"position_force\"",
            "kind = \"magic\"",
            vec!["own.toml", "magic", "position_force"],
        ),
        ("[hand]", "[hand", vec!["own.toml"]),
    ];
    for (old, new, words) in cases {
        scenario(&session, old, new);
        for command in ["session", "lockstep"] {
            refused(&session, &[command, "--scenario", "own.toml"], &words);
        }
    }
    refused(
        &session,
        &["session", "--scenario", "nowhere.toml"],
        &["nowhere.toml"],
    );
    refused(&session, &["session", "--rtt", "-3"], &["--rtt", "-"]);
    refused(&session, &["session", "--duration", "0"], &["--duration"]);
    refused(&session, &["session", "--session", "a/b"], &["a/b"]);
    refused(
        &session,
        &["lockstep", "--hand", "nowhere.csv"],
        &["nowhere.csv"],
    );
}

#[test]
fn a_hand_that_is_no_recording() {
    let session = Session::new();
    let cases = [
        ("", "line 1"),
        ("t_s,x_m\n0,0\n", "y_m"),
        ("t_s,x_m,y_m\n0,0,0\n1,nan,0\n", "line 3"),
        ("t_s,x_m,y_m\n1,0,0\n0,0,0\n", "line 3"),
        ("t_s,x_m,y_m\n0,zero,0\n", "line 2"),
    ];
    for (text, word) in cases {
        fs::write(session.folder().join("hand.csv"), text).expect("scratch folder");
        refused(
            &session,
            &["lockstep", "--hand", "hand.csv"],
            &["hand.csv", word],
        );
    }
}

#[test]
fn a_port_that_is_taken() {
    let session = Session::new();
    let taken = TcpListener::bind("127.0.0.1:0").expect("a port");
    let endpoint = format!("tcp/{}", taken.local_addr().expect("an address"));
    let name = session.name().to_owned();
    let arguments = ["session", "--session", &name, "--link-endpoint", &endpoint];
    refused(&session, &arguments, &[&endpoint, "--link-endpoint"]);
    let arguments = [
        "session",
        "--session",
        &name,
        "--middleware",
        "zenoh",
        "--link-endpoint",
        &session.link_endpoint(),
        "--router-endpoint",
        &endpoint,
    ];
    refused(&session, &arguments, &[&endpoint, "--router-endpoint"]);
}

#[test]
fn a_session_that_runs_already_and_a_recording_that_exists() {
    let session = Session::new();
    let mut process = start(&session, &[]);
    await_enabled(&session, &mut process);
    let name = session.name().to_owned();
    let other = format!("tcp/127.0.0.1:{}", ferntast_tests::free_tcp_port());
    let arguments = ["session", "--session", &name, "--link-endpoint", &other];
    refused(&session, &arguments, &[&name]);
    let free = [
        "session",
        "--session",
        "x",
        "--link-endpoint",
        &other,
        "--record",
        "run",
    ];
    refused(&session, &free, &["run", "--record"]);
    // It was not disturbed.
    process.interrupt();
    let summary = process.wait(PATIENCE).success().json();
    assert_eq!(summary["recorder"]["lost"], 0);
}

#[test]
fn no_permission_for_real_time_priority_is_told_and_it_runs_on() {
    let session = Session::new();
    let mut command = session.ferntast_here(&["session", "--json", "--duration", "2"]);
    // SAFETY: both calls are async-signal-safe; the limits are those of the child.
    unsafe {
        command.pre_exec(|| {
            const CAP_SYS_NICE: libc::c_ulong = 23;
            let none = libc::rlimit {
                rlim_cur: 0,
                rlim_max: 0,
            };
            libc::setrlimit(libc::RLIMIT_RTPRIO, &none);
            // Refused without privilege, which then has not got it either.
            libc::prctl(libc::PR_CAPBSET_DROP, CAP_SYS_NICE, 0, 0, 0);
            Ok(())
        });
    }
    let ended = Process::spawn(command).wait(PATIENCE).success();
    assert!(
        ended.stderr.contains("no real-time priority"),
        "{}",
        ended.stderr
    );
    assert!(ended.stderr.contains("ferntast doctor"), "{}", ended.stderr);
    let summary = ended.json();
    let faults = summary["nodes"]["servo"]["faults"]
        .as_array()
        .expect("faults");
    assert!(
        faults.contains(&serde_json::json!("no realtime priority")),
        "{summary:#}"
    );
    // It runs on; how late it is then is the machine's affair.
    let visited = summary["states"]["follower"]["visited"]
        .as_array()
        .expect("states");
    assert!(
        visited.contains(&serde_json::json!("ENABLED")),
        "{summary:#}"
    );
    assert!(
        crate::support::number(&summary, "servo.rate_hz") > 300.0,
        "{summary:#}"
    );
}

#[test]
fn a_word_that_is_not_known_and_a_session_that_does_not_run() {
    let session = Session::new();
    refused(
        &session,
        &["state", "follower", "jump"],
        &["jump", "resume"],
    );
    refused(&session, &["node", "brain"], &["brain", "servo"]);
    let ended = crate::support::state(&session, "follower", "enable");
    assert_eq!(ended.status.code(), Some(1), "{ended:#?}");
    assert!(ended.stderr.contains(session.name()), "{ended:#?}");
}
