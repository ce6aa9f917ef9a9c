//! Schedules of faults from the command line.

use std::{collections::BTreeSet, fs, path::Path};

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

/// Arms of seven and six joints in space, by their own limits.
#[test]
fn arms_in_space_hold_under_seeded_faults() {
    for (arm, seeds) in [("panda", "0..30"), ("ur5", "30..50"), ("xarm7", "50..70")] {
        let session = Session::new();
        let json = faults(&session, &[arm, "--seeds", seeds, "-o", "found"]);
        let found = json["violations"].as_array();
        assert!(found.is_some_and(Vec::is_empty), "{arm}: {json:#}");
        assert!(number(&json, "schedules") >= 20.0, "{json:#}");
        let count = |name: &str| json["faults"][name].as_u64().unwrap_or_default();
        assert!(count("crash") > 2 && count("word") > 5, "{arm}: {json:#}");
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

/// Schedules of which a million found that something did not hold, one of each kind, a file
/// each by its seed. Arms held late, led on, or began with what was of before; and the judge's own:
/// the speed of a joint whose sensor is stuck, a clock that jumps together with an encoder, a
/// copy that overtakes its frame.
#[test]
fn what_a_million_schedules_found_holds() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/offline/schedules");
    let files = fs::read_dir(&folder).expect("schedules");
    let files: Vec<_> = files.map(|file| file.expect("a file").path()).collect();
    assert_eq!(files.len(), 13, "{files:#?}");
    for schedule in files {
        let session = Session::new();
        let path = schedule.to_str().expect("UTF-8");
        let json = faults(&session, &["--replay", path, "-o", "again"]);
        let found = json["violations"].as_array();
        assert!(found.is_some_and(Vec::is_empty), "{path}: {json:#}");
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

/// The clutch, opened and closed while other things go wrong: in a hold, over a gap in the link, with
/// a host that stands still, a master that is started again.
#[test]
fn a_clutch_leads_the_arm_nowhere_whatever_goes_wrong_meanwhile() {
    let session = Session::new();
    let clutch = |at: i64, word: &str| {
        format!("{{ at_ms = {at}, fault = \"word\", device = \"leader\", word = \"{word}\" }},\n")
    };
    let laws = [
        "position_force",
        "wave",
        "four_channel",
        "two_layer",
        "model_mediated",
    ];
    let wrong = [
        "",
        "{ at_ms = 1700, fault = \"blackout\", way = \"forth\", ms = 15 },",
        "{ at_ms = 1690, fault = \"host_stall\", side = \"operator\", ms = 9 },",
        "{ at_ms = 1650, fault = \"word\", device = \"follower\", word = \"pause\" },
         { at_ms = 1680, fault = \"word\", device = \"both\", word = \"resume\" },",
        "{ at_ms = 1650, fault = \"crash\", node = \"master\" },
         { at_ms = 1900, fault = \"word\", device = \"both\", word = \"resume\" },",
        "{ at_ms = 1700, fault = \"loss\", way = \"forth\", share = 0.5, ms = 60 },",
    ];
    for (number, law) in laws.iter().enumerate() {
        for (other, wrong) in wrong.iter().enumerate() {
            let events = [
                clutch(1300, "clutch"),
                clutch(1700, "engage"),
                clutch(2600, "clutch"),
                clutch(2603, "engage"),
                clutch(3000, "clutch"),
                clutch(3400, "engage"),
            ];
            let name = format!("clutch_{number}_{other}.toml");
            let text = format!(
                "scenario = \"rokviss\"\nseed = {other}\nlaw = \"{law}\"\nlength_ms = 3800\nevent = [\n{}{wrong}\n]\n",
                events.concat()
            );
            fs::write(session.folder().join(&name), text).expect("scratch folder");
            let json = faults(&session, &["--replay", &name]);
            let none = json["violations"].as_array().is_none_or(Vec::is_empty);
            assert!(none, "{law}, {wrong}: {json:#}");
        }
    }
}
