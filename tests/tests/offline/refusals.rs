//! Bad input: one message that names what, where and how to correct it; nothing moves.

use std::{fs, net::TcpListener};

use ferntast_tests::{Session, refused, root, state};

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
fn a_word_that_is_not_known_and_a_session_that_does_not_run() {
    let session = Session::new();
    refused(
        &session,
        &["state", "follower", "jump"],
        &["jump", "resume"],
    );
    refused(&session, &["node", "brain"], &["brain", "servo"]);
    let ended = state(&session, "follower", "enable");
    assert_eq!(ended.status.code(), Some(1), "{ended:#?}");
    assert!(ended.stderr.contains(session.name()), "{ended:#?}");
}
