//! Studies in parts tell what one run tells, byte for byte.

use std::{fs, path::Path};

use ferntast_tests::{Session, refused, run};

const SWEEP: &str = r#"
description = "Small."
rtt_ms = [0, 300]
jitter_ms = [0, 5]
loss = [0]
environments = ["soft_spring", "hard_wall"]
seeds = [1]
hand = { mass = 0.5, damping = 20.0, stiffness = 300.0 }
laws = [{ kind = "position_force", force_scale = 1.0 }, { kind = "wave", force_scale = 1.0 }]
"#;

/// Runs `study` whole and in three parts; gives what both told.
fn whole_and_merged(session: &Session, study: &[&str]) -> [String; 2] {
    whole_and_parts(session, study, &["1.toml", "2.toml", "3.toml"])
}

/// Runs `study` whole and in as many parts as there are files; gives what both told.
fn whole_and_parts(session: &Session, study: &[&str], parts: &[&str]) -> [String; 2] {
    let whole = run(session, &[study, &["--json"]].concat())
        .success()
        .stdout;
    for (number, file) in (1..).zip(parts) {
        let shard = format!("{number}/{}", parts.len());
        let part = ["--shard", &shard, "--part", file];
        run(session, &[study, &part].concat()).success();
    }
    let merged = run(session, &[&["merge", "--json"][..], parts].concat());
    [whole, merged.success().stdout]
}

fn is_equal([whole, merged]: [String; 2]) {
    assert!(whole.len() > 100, "{whole}");
    assert_eq!(whole, merged);
}

#[test]
fn of_sweeps_and_random_cases() {
    let session = Session::new();
    fs::write(session.folder().join("small.toml"), SWEEP).expect("scratch folder");
    is_equal(whole_and_merged(&session, &["sweep", "small.toml"]));
    let random = ["sweep", "small.toml", "--random", "7"];
    is_equal(whole_and_merged(&session, &random));
    let page = ["merge", "1.toml", "2.toml", "3.toml", "-o", "page"];
    refused(&session, &["merge", "1.toml", "3.toml"], &["missing: 2"]);
    run(&session, &page).success();
}

#[test]
fn of_blind_tests() {
    let session = Session::new();
    let blind = ["challenge", "blind", "--repeats", "1", "--strengths", "1"];
    let few = [
        "--hide",
        "stribeck",
        "--nothing",
        "2",
        "--two",
        "1",
        "--real-like",
        "1",
        "--kind",
        "coarse_encoder",
        "--kind",
        "one_session",
    ];
    is_equal(whole_and_merged(&session, &[&blind[..], &few].concat()));
}

#[test]
fn of_schedules_of_faults_but_for_the_time_they_took() {
    let session = Session::new();
    let seeds = ["faults", "rokviss", "--seeds", "40..70"];
    let untimed = |text: String| {
        let lines = text.lines().filter(|line| !line.contains("per_minute"));
        lines.map(str::to_owned).collect::<Vec<_>>()
    };
    // One part is one, too.
    for parts in [&["1.toml", "2.toml", "3.toml"][..], &["all.toml"]] {
        let [whole, merged] = whole_and_parts(&session, &seeds, parts).map(untimed);
        assert!(whole.len() > 10, "{whole:#?}");
        assert_eq!(whole, merged);
    }
}

#[test]
fn of_a_folder_of_experiments() {
    let session = Session::new();
    for seed in ["76", "77"] {
        let make = ["challenge", "new", seed, "--seed", seed];
        run(&session, &make).success();
        let own = fs::read_to_string(session.folder().join(seed).join("experiment.toml"));
        let text = own
            .expect("an experiment")
            .replace("recording = \"", &format!("recording = \"../{seed}/"));
        let folder = session.folder().join("all");
        fs::create_dir_all(&folder).expect("scratch folder");
        fs::write(folder.join(format!("{seed}.toml")), text).expect("scratch folder");
    }
    let auto = [
        "lab",
        "auto",
        "all",
        "-o",
        "completed",
        "--quick",
        "--force",
    ];
    is_equal(whole_and_merged(&session, &auto));
    assert!(has_files(&session.folder().join("completed")));
    for part in ["1/1", "1/2"] {
        let one = ["lab", "auto", "76/experiment.toml", "--shard", part];
        refused(&session, &one, &["is one experiment"]);
    }
}

fn has_files(folder: &Path) -> bool {
    fs::read_dir(folder).is_ok_and(|mut own| own.next().is_some())
}
