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

/// What a million schedules found beyond them, one of each kind. A hand after a gap of its host
/// was good, and led on, for longer than one that is silent; friction went with a torque that
/// no sensor measures; an arm was enabled by what was measured before it stood still, and
/// began with the torque of before a fault. And the judge's own: speed of a joint whose
/// sensor is stuck, a clock that jumps together with an encoder, a copy that overtakes its
/// frame. And after it: a release that drove a joint that nobody measured, and one whose way
/// was used up by ringing.
const FOUND: [&str; 11] = [
    r#"
scenario = "rokviss"
seed = 6231179
law = "position_force"
length_ms = 658
event = [
    { at_ms = 586, fault = "host_stall", side = "operator", ms = 9 },
    { at_ms = 592, fault = "second_hand", ms = 1 },
]
"#,
    r#"
scenario = "rokviss"
seed = 6567613
law = "four_channel"
length_ms = 870
event = [
    { at_ms = 715, fault = "sensor", ms = 166, sensor = { torque_error = -120.28886859626454 } },
]
"#,
    r#"
scenario = "rokviss"
seed = 6183726
law = "tdpa"
length_ms = 1473
event = [
    { at_ms = 431, fault = "stall", node = "master", ms = 47 },
    { at_ms = 935, fault = "word", device = "leader", word = "pause" },
    { at_ms = 1194, fault = "sensor", sensor = "stuck", ms = 355 },
    { at_ms = 1205, fault = "word", device = "leader", word = "resume" },
]
"#,
    r#"
scenario = "rokviss"
seed = 6253704
law = "four_channel"
length_ms = 947
event = [
    { at_ms = 675, fault = "crash", node = "arm" },
    { at_ms = 815, fault = "word", device = "both", word = "disable" },
    { at_ms = 896, fault = "word", device = "both", word = "enable" },
]
"#,
    r#"
scenario = "rokviss"
seed = 6595512
law = "model_mediated"
length_ms = 2186
event = [
    { at_ms = 1951, fault = "host_stall", side = "arm", ms = 75 },
    { at_ms = 2007, fault = "channel", round_trip_ms = 20.620296252991224, jitter_ms = 6.047047104904568, loss = 0.10936754741355795 },
    { at_ms = 2122, fault = "stall", node = "arm", ms = 12 },
    { at_ms = 2123, fault = "word", device = "follower", word = "resume" },
]
"#,
    r#"
scenario = "rokviss"
seed = 6720356
law = "model_mediated"
length_ms = 1833
event = [
    { at_ms = 1275, fault = "loss", way = "back", share = 0.20588556477894898, ms = 44 },
    { at_ms = 1599, fault = "law_switch", law = "tdpa" },
    { at_ms = 1719, fault = "word", device = "follower", word = "pause" },
    { at_ms = 1753, fault = "word", device = "both", word = "resume" },
    { at_ms = 1771, fault = "stall", node = "arm", ms = 10 },
]
"#,
    r#"
scenario = "rokviss"
seed = 6644635
law = "position_force"
length_ms = 1977
event = [
    { at_ms = 1922, fault = "clock_jump", side = "arm", ms = 60 },
    { at_ms = 1922, fault = "sensor", ms = 8, sensor = { zero_error = -0.03297302608466407 } },
]
"#,
    r#"
scenario = "rokviss"
seed = 6847817
law = "position_force"
length_ms = 453
event = [
    { at_ms = 247, fault = "clock_jump", side = "arm", ms = 15 },
    { at_ms = 350, fault = "stall", node = "link_leader", ms = 11 },
    { at_ms = 359, fault = "crash", node = "master" },
]
"#,
    r#"
scenario = "rokviss"
seed = 6398424
law = "position_position"
length_ms = 1456
event = [
    { at_ms = 803, fault = "loss", way = "back", share = 0.882103235593738, ms = 8 },
    { at_ms = 986, fault = "stall", node = "link_follower", ms = 396 },
    { at_ms = 1266, fault = "jitter", way = "back", most_ms = 6, ms = 210 },
    { at_ms = 1297, fault = "word", device = "follower", word = "resume" },
    { at_ms = 1380, fault = "duplicate", way = "back", share = 0.5674703200606066, ms = 23 },
]
"#,
    r#"
scenario = "rokviss"
seed = 8025800
law = "position_position"
length_ms = 827
event = [
    { at_ms = 598, fault = "crash", node = "estimator" },
    { at_ms = 634, fault = "sensor", sensor = "stuck", ms = 158 },
    { at_ms = 747, fault = "word", device = "both", word = "resume" },
]
"#,
    r#"
scenario = "rokviss"
seed = 8003474
law = "four_channel"
length_ms = 2056
event = [
    { at_ms = 1614, fault = "blackout", way = "back", ms = 420 },
    { at_ms = 1701, fault = "word", device = "both", word = "resume" },
]
"#,
];

#[test]
fn what_a_million_schedules_found_holds() {
    for schedule in LATE.iter().chain(&FOUND) {
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
