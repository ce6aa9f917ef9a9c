//! The same nodes in virtual time: same seed, same bytes; fed again, same outputs.

use std::fs;

use ferntast_tests::{PATIENCE, Process, Session, number, run};

fn record(session: &Session, folder: &str, seed: &str) -> Vec<u8> {
    let path = format!("{folder}/run");
    fs::create_dir(session.folder().join(folder)).expect("scratch folder");
    let arguments = [
        "lockstep",
        "--duration",
        "6",
        "--seed",
        seed,
        "--record",
        &path,
        "--json",
    ];
    run(session, &arguments).success();
    fs::read(session.folder().join(path).join("run_0.mcap")).expect("the recording's file")
}

#[test]
fn the_same_seed_gives_the_same_bytes_and_another_does_not() {
    let session = Session::new();
    let first = record(&session, "first", "7");
    let second = record(&session, "second", "7");
    let other = record(&session, "other", "8");
    assert!(first.len() > 1_000_000);
    assert!(first == second, "two runs of the same seed differ");
    assert!(first != other, "the seed changes nothing");
}

#[test]
fn a_recording_fed_again_gives_the_same_outputs() {
    let session = Session::new();
    record(&session, "first", "3");
    let replay = run(&session, &["replay", "first/run", "--json"])
        .success()
        .json();
    assert_eq!(replay["equal"], true, "{replay:#}");
    assert_eq!(replay["different"], 0);
    // Six seconds of servo (torque, setpoint) and estimator (pose, forces, contact).
    assert!(
        replay["compared"]
            .as_u64()
            .is_some_and(|count| count > 30_000),
        "{replay:#}"
    );
}

#[test]
fn it_runs_faster_than_real_time_with_all_nodes() {
    let session = Session::new();
    let summary = run(&session, &["lockstep", "rokviss", "--json"])
        .success()
        .json();
    assert!(number(&summary, "real_time_factor") > 1.0);
    assert!((number(&summary, "duration_s") - 20.0).abs() < 1e-9);
    assert_eq!(
        summary["contact"]["edges"],
        serde_json::json!(["lubricated", "unlubricated", "spring"])
    );
    assert_eq!(summary["states"]["follower"]["final"], "ENABLED");
}

#[test]
fn a_recording_that_the_disk_has_no_room_for_is_a_failure() {
    let session = Session::new();
    let arguments = ["lockstep", "--duration", "6", "--record", "run", "--json"];
    let command = session.ferntast(&arguments);
    let ended = Process::spawn_on_a_small_disk(command, 1 << 20)
        .wait(PATIENCE)
        .failure();
    let told = ended.json()["recording_fault"].to_string();
    assert!(told.contains("it is not closed: free some room"), "{told}");
    assert!(ended.stderr.contains("error:"), "{}", ended.stderr);
    run(&session, &["bag", "repair", "run", "--json"]).success();
    let info = run(&session, &["bag", "info", "run", "--json"]).success();
    assert!(number(&info.json(), "duration_s") > 0.5);
}
