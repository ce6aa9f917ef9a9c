//! Experiments on the arm.

use std::fs;

use ferntast_tests::{Session, number, refused, run};

#[test]
fn an_experiment_is_the_same_for_the_same_seed_and_the_lab_reads_it() {
    let session = Session::new();
    // The recording knows its own name, so it has to be the same.
    let spring = |folder: &str, seed: &str| {
        fs::create_dir(session.folder().join(folder)).expect("a new folder");
        let folder = format!("{folder}/spring");
        let folder = folder.as_str();
        let arguments = [
            "experiment",
            "spring",
            "--speeds",
            "5,20",
            "--time-per-speed",
            "4",
            "--temperature",
            "10",
            "--day",
            "57",
            "--seed",
            seed,
            "-o",
            folder,
            "--json",
        ];
        let told = run(&session, &arguments).success().json();
        assert!(number(&told, "duration_s") > 8.0);
        let path = session.folder().join(folder);
        let file = fs::read_dir(&path)
            .expect("a folder")
            .filter_map(Result::ok)
            .map(|entry| entry.path())
            .find(|path| path.extension().is_some_and(|end| end == "mcap"));
        fs::read(file.expect("an MCAP file")).expect("its bytes")
    };
    let first = spring("first", "3");
    assert_eq!(first, spring("second", "3"));
    assert_ne!(first, spring("third", "4"));
    let folder = session.folder().join("first/spring");
    let folder = folder.to_str().expect("a path in UTF-8");
    let told = run(&session, &["lab", "compare", folder, "--json"])
        .success()
        .json();
    // 5 and 20 deg/s alone tell little of each parameter, but all of the torque.
    assert!(
        number(&told["joints"]["joint_2"]["rms"], "held_out") < 1.0,
        "{:#}",
        told["joints"]["joint_2"]["rms"]
    );
}

#[test]
fn experiments_that_the_arm_cannot_do_are_refused() {
    let session = Session::new();
    refused(
        &session,
        &["experiment", "spring", "--speeds", "41", "-o", "a"],
        &["speed", "40 deg/s"],
    );
    refused(
        &session,
        &["experiment", "contact", "--forces", "500", "-o", "a"],
        &["force", "100 N"],
    );
    refused(
        &session,
        &["experiment", "sine", "--frequencies", "0", "-o", "a"],
        &["frequency", "Hz"],
    );
    refused(
        &session,
        &["experiment", "campaign", "no_such", "-o", "a"],
        &["no_such", "mission"],
    );
    refused(
        &session,
        &["experiment", "spring", "--temperature", "900", "-o", "a"],
        &["temperature", "degC"],
    );
}
