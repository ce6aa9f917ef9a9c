//! Schedules of faults from the command line.

use std::{collections::BTreeSet, fs};

use ferntast_tests::{Session, number, refused, run};
use serde_json::Value;

/// Invariants that do not hold yet, and why. Empty when all is mended.
const KNOWN: [&str; 0] = [];

/// Runs `ferntast faults` with `--json`; its exit code says whether everything held.
fn faults(session: &Session, arguments: &[&str]) -> Value {
    let ended = run(session, &[&["faults"], arguments, &["--json"]].concat());
    let json: Value = serde_json::from_str(&ended.stdout).unwrap_or_else(|_| panic!("{ended:#?}"));
    let violated = json["violations"]
        .as_array()
        .is_some_and(|own| !own.is_empty());
    assert_eq!(ended.status.code(), Some(i32::from(violated)), "{ended:#?}");
    json
}

#[test]
fn a_session_holds_under_seeded_faults() {
    let session = Session::new();
    let json = faults(&session, &["rokviss", "--seeds", "0..150", "-o", "found"]);
    assert_eq!(json["schedules"], 150);
    assert!(number(&json, "schedules_per_minute") > 100.0, "{json:#}");
    let count = |name: &str| json["faults"][name].as_u64().unwrap_or_default();
    for name in [
        "crash", "stall", "clock", "blackout", "forge", "garbage", "sensor", "word",
    ] {
        assert!(count(name) > 5, "{name}: {json:#}");
    }
    let checked = json["invariants"].as_array().map_or(0, Vec::len);
    assert!((15..40).contains(&checked), "{json:#}");
    let known: BTreeSet<&str> = KNOWN.into();
    for found in json["violations"].as_array().into_iter().flatten() {
        let name = found["invariant"].as_str().unwrap_or_default();
        assert!(known.contains(name), "{found:#}");
    }
}

const ONE: &str = r#"
scenario = "rokviss"
seed = 5
law = "wave"
length_ms = 700

[[event]]
at_ms = 300
fault = "crash"
node = "master"

[[event]]
at_ms = 400
fault = "blackout"
way = "forth"
ms = 50
"#;

#[test]
fn a_schedule_in_a_file_is_run_again_and_recorded() {
    let session = Session::new();
    fs::write(session.folder().join("one.toml"), ONE).expect("scratch folder");
    let json = faults(&session, &["--replay", "one.toml"]);
    assert_eq!(json["recording"], "./one");
    let info = run(&session, &["bag", "info", "one", "--json"])
        .success()
        .json();
    assert!(
        info.to_string().contains("/follower/measured_js"),
        "{info:#}"
    );
    let first = fs::read(session.folder().join("one/one_0.mcap")).expect("the recording");
    // The same file gives the same bytes.
    faults(&session, &["--replay", "one.toml", "-o", "again"]);
    let second = fs::read(session.folder().join("again/one/one_0.mcap")).expect("the recording");
    assert!(first.len() > 100_000 && first == second);
    refused(
        &session,
        &["faults", "--replay", "one.toml"],
        &["one", "there already"],
    );
}

/// Two of a million schedules in which the arm held late: what a dead master had said is good
/// for 4 ms, and the servo waited 25 ms more.
const LATE: [&str; 2] = [
    r#"
scenario = "rokviss"
seed = 119569
law = "model_mediated"
length_ms = 2200
event = [
    { at_ms = 444, fault = "clock_jump", side = "arm", ms = 4 },
    { at_ms = 2130, fault = "crash", node = "master" },
]
"#,
    r#"
scenario = "rokviss"
seed = 123225
law = "position_position"
length_ms = 1200
event = [
    { at_ms = 348, fault = "clock_jump", side = "arm", ms = -10 },
    { at_ms = 693, fault = "loss", way = "forth", share = 0.7844969014442567, ms = 18 },
    { at_ms = 1087, fault = "loss", way = "forth", share = 0.7303030969275016, ms = 31 },
    { at_ms = 1093, fault = "word", device = "follower", word = "enable" },
    { at_ms = 1117, fault = "crash", node = "master" },
]
"#,
];

#[test]
fn a_master_that_dies_is_missed_in_time() {
    for schedule in LATE {
        let session = Session::new();
        fs::write(session.folder().join("late.toml"), schedule).expect("scratch folder");
        let json = faults(&session, &["--replay", "late.toml"]);
        let found = json["violations"].as_array();
        assert!(found.is_some_and(Vec::is_empty), "{json:#}");
    }
}

#[test]
fn what_cannot_be_run_is_refused() {
    let session = Session::new();
    let write = |name: &str, text: String| {
        fs::write(session.folder().join(name), text).expect("scratch folder");
    };
    write("law.toml", ONE.replace("wave", "magic"));
    write("fault.toml", ONE.replace("blackout", "flood"));
    write("length.toml", ONE.replace("700", "-1"));
    write("planted.toml", format!("planted = \"one_hand\"\n{ONE}"));
    let cases: [(&[&str], &[&str]); 9] = [
        (&["nonsense"], &["nonsense", "rokviss"]),
        (&["operator"], &["scripted"]),
        (&["--seeds", "7..3"], &["A..B"]),
        (&["--minutes", "-1"], &["minutes"]),
        (&["--replay", "missing.toml"], &["missing.toml"]),
        (&["--replay", "law.toml"], &["magic", "wave"]),
        (&["--replay", "fault.toml"], &["fault.toml", "flood"]),
        (&["--replay", "length.toml"], &["length_ms", "-1"]),
        (&["--replay", "planted.toml"], &["one_hand", "planted_bugs"]),
    ];
    for (arguments, words) in cases {
        refused(&session, &[&["faults"], arguments].concat(), words);
    }
}
