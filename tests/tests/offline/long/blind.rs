//! The lab on recordings that nobody has seen.

use std::time::Duration;

use ferntast_tests::{Process, Session, is_thorough, number, run};
use serde_json::Value;

/// What `ferntast challenge blind` tells of the seed that every test here has.
fn blind(session: &Session, arguments: &[&str]) -> Value {
    let mut command = session.ferntast(&["challenge", "blind", "--seed", "424242", "--json"]);
    command.args(arguments);
    let limit = Duration::from_secs(if is_thorough() { 1800 } else { 900 });
    Process::spawn(command).wait(limit).success().json()
}

/// At half the strength an effect is hard enough to find that a change for the worse shows.
fn strengths() -> &'static str {
    if is_thorough() { "1,0.5,0.25" } else { "0.5" }
}

/// Recordings that hide an effect of the catalogue at one strength: each once. `ferntast challenge
/// blind` says it of as many as one likes.
fn hidden(session: &Session, subject: &str) -> f64 {
    let catalogue = Process::spawn(session.ferntast(&["lab", "effects", "--json"]))
        .wait(Duration::from_secs(60))
        .success()
        .json();
    let rows = catalogue.as_array().into_iter().flatten();
    // A second one of a kind counts beside the first alone. The bench measures load and temperature,
    // so that it has nothing that goes with them unmeasured.
    let first = |row: &&Value| row["of"] == subject && row["another"].is_null();
    let recorded = |row: &&Value| row["of_unmeasured"].is_null();
    rows.filter(first).filter(recorded).count() as f64
}

#[test]
fn blind_on_recordings_that_nobody_has_seen() {
    let session = Session::new();
    let (nothing, two) = if is_thorough() {
        ("60", "6")
    } else {
        ("10", "3")
    };
    let told = blind(
        &session,
        &[
            "--repeats",
            "1",
            "--strengths",
            strengths(),
            "--nothing",
            nothing,
            "--two",
            two,
            "--real-like",
            "0",
        ],
    );
    let share = |value: &Value| number(value, "found") / number(value, "tried");
    assert_eq!(
        number(&told["right_first"]["0.5"], "tried"),
        hidden(&session, "joint")
    );
    for (row, strength, least) in [
        ("right_first", "1", 0.95),
        ("right_first", "0.5", 0.80),
        ("in_family", "1", 0.99),
        // Too few sessions prove little of temperature and date.
        ("in_family", "0.5", 0.95),
        ("in_family", "0.25", 0.90),
        ("at_least_suspected", "0.5", 0.95),
        ("at_least_suspected", "0.25", 0.90),
        ("unknown_not_named", "1", 0.95),
        ("unknown_not_named", "0.5", 0.95),
        ("as_good_as_true", "1", 0.90),
        ("as_good_as_true", "0.5", 0.95),
    ] {
        if !strengths().split(',').any(|own| own == strength) {
            continue;
        }
        let found = share(&told[row][strength]);
        assert!(
            found >= least,
            "{row} at {strength}: {found}, {:#}",
            told["misses"]
        );
    }
    assert!(share(&told["resolved"]) >= 0.90, "{:#}", told["misses"]);
    assert!(share(&told["one_of_two"]) >= 0.8, "{told:#}");
    assert!(share(&told["false_alarms"]) <= 0.02, "{:#}", told["misses"]);
    // Intervals of 95 % hold the true value about as often as they say; less where the
    // lab's law is an approximation of the bench's (elasticity, presliding, backlash).
    let coverage = &told["coverage"];
    for (of, least) in [("fitted", 0.87), ("searched", 0.65), ("one_session", 0.87)] {
        let held = share(&coverage[of]);
        // Of few intervals all may hold.
        let are_few = !is_thorough() && number(&coverage[of], "tried") < 100.0;
        let most = if are_few { 1.0 } else { 0.995 };
        assert!((least..=most).contains(&held), "{of}: {held}, {coverage:#}");
    }
}

#[test]
fn blind_on_contacts_that_nobody_has_seen() {
    let session = Session::new();
    let (nothing, two) = if is_thorough() {
        ("40", "6")
    } else {
        ("8", "3")
    };
    let told = blind(
        &session,
        &[
            "--contact",
            "--repeats",
            "1",
            "--strengths",
            strengths(),
            "--nothing",
            nothing,
            "--two",
            two,
        ],
    );
    let share = |value: &Value| number(value, "found") / number(value, "tried");
    let misses = &told["misses"];
    assert_eq!(
        number(&told["right_first"]["0.5"], "tried"),
        hidden(&session, "contact")
    );
    assert!(share(&told["right_first"]["0.5"]) >= 0.80, "{misses:#}");
    if is_thorough() {
        assert!(share(&told["right_first"]["1"]) >= 0.95, "{misses:#}");
        assert!(share(&told["in_family"]["1"]) >= 0.99, "{misses:#}");
        assert!(share(&told["unknown_not_named"]["1"]) >= 0.90, "{misses:#}");
    }
    assert!(share(&told["one_of_two"]) >= 0.8, "{told:#}");
    assert!(share(&told["false_alarms"]) <= 0.03, "{misses:#}");
}

/// Recordings like real ones, one lack of the bench's at a time. What is named beyond what is
/// there, or told to be indistinguishable from it: measured on 40 of each kind at another seed
/// 0 to 2 of 40. 4 or 20 of each kind are few: the bounds leave room for chance.
#[test]
fn blind_on_recordings_like_real_ones() {
    let session = Session::new();
    let of_each = if is_thorough() { 20.0 } else { 4.0 };
    let told = blind(
        &session,
        &[
            "--repeats",
            "0",
            "--nothing",
            "0",
            "--two",
            "0",
            "--real-like",
            &of_each.to_string(),
        ],
    );
    let rows = told["real_like"].as_object().expect("rows by kind");
    assert_eq!(rows.len(), 9, "{rows:#?}");
    let mut beyond_family = 0.0;
    for (kind, row) in rows {
        assert_eq!(number(row, "recordings"), of_each, "{kind}");
        assert_eq!(number(row, "false_names.tried"), of_each, "{kind}");
        let own = number(row, "false_names.found") - number(row, "false_in_family");
        match kind.as_str() {
            // A load that a model gives wrongly is told as that: 1 of 40 at the other seed.
            "uncertain_load" => {
                let all = number(row, "false_names.found");
                assert!((0.0..=1.0).contains(&own) && all <= 1.0, "{row:#}");
                let right = number(row, "right_first.found");
                assert!((0.9 * of_each..=of_each).contains(&right), "{row:#}");
            }
            _ => assert!(own <= 0.1 * of_each + 0.5, "{kind}: {row:#}"),
        }
        beyond_family += own;
        let least = match kind.as_str() {
            // Few moves show few effects, and of one session nobody knows how it varies.
            "little_excitation" => 0.0,
            "uncertain_load" => 0.9,
            "one_session" => 0.5,
            _ => 0.75,
        };
        // One of few is a large share.
        let slack = if is_thorough() { 0.0 } else { 1.0 };
        let found = number(row, "in_family.found");
        let least = least * number(row, "in_family.tried").max(1.0) - slack;
        assert!(found >= least, "{kind}: {row:#}");
    }
    assert!(beyond_family <= 0.25 * of_each, "{told:#}");
}

/// Two recordings of another seed that hide a channel that is late. By a coarse encoder that is not found with the slower
/// filter, and `elasticity` was named in its place; of one session it was found there with too little
/// significance for one of fifty effects, and `clock_drift` was named, which explains less.
#[test]
fn blind_where_a_late_channel_may_be_noise_nothing_is_named_in_its_place() {
    let session = Session::new();
    let told = |kind: &str, seed: &str| {
        let none = ["--repeats", "0", "--nothing", "0", "--two", "0"];
        let one = ["--real-like", "1", "--kind", kind, "--seed", seed, "--json"];
        let arguments = [&["challenge", "blind"], &none[..], &one].concat();
        let told = run(&session, &arguments).success().json();
        told["real_like"][kind].clone()
    };
    let coarse = told("coarse_encoder", "31000033");
    assert_eq!(number(&coarse, "false_names.found"), 0.0, "{coarse:#}");
    let one = told("one_session", "31000010");
    assert_eq!(number(&one, "right_first.found"), 1.0, "{one:#}");
}
