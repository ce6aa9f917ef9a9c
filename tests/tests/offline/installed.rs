//! The program far from its checkout: configuration inside, manual pages, completions.

use std::fs;

use ferntast_tests::{PATIENCE, Process, Session, number, refused, run};

#[test]
fn the_configuration_inside_is_exported_and_then_counts() {
    let session = Session::new();
    let listed = run(&session, &["config", "list"]).success().stdout;
    let names: Vec<&str> = listed.lines().collect();
    assert!(names.contains(&"scenarios/rokviss.toml"), "{names:?}");

    let exported = run(&session, &["config", "export", "--json"])
        .success()
        .json();
    assert_eq!(
        exported["written"].as_array().map(Vec::len),
        Some(names.len())
    );
    let scenario = session.folder().join("config/scenarios/rokviss.toml");
    let text = fs::read_to_string(&scenario).expect("exported");
    let shown = run(&session, &["config", "show", "scenarios/rokviss.toml"]).success();
    assert_eq!(shown.stdout, text);

    // A second time keeps what was changed, and the change counts.
    let changed = text.replace("duration = 20.0 ", "duration = 0.5 ");
    assert_ne!(changed, text);
    fs::write(&scenario, &changed).expect("scratch");
    let again = run(&session, &["config", "export", "--json"])
        .success()
        .json();
    assert_eq!(again["written"].as_array().map(Vec::len), Some(0));
    assert_eq!(again["kept"].as_array().map(Vec::len), Some(names.len()));
    let result = run(&session, &["lockstep", "--json"]).success().json();
    assert_eq!(number(&result, "duration_s"), 0.5);

    refused(
        &session,
        &["config", "show", "arms/rokvis.toml"],
        &["arms/rokvis.toml", "arms/rokviss.toml"],
    );
}

#[test]
fn every_command_has_a_manual_page_and_every_shell_completions() {
    let session = Session::new();
    run(&session, &["man", "-o", "man1"]).success();
    let help = run(&session, &["--help"]).success().stdout;
    let commands = help
        .lines()
        .skip_while(|line| !line.starts_with("Commands:"))
        .skip(1);
    let commands: Vec<&str> = commands
        .take_while(|line| !line.is_empty())
        .filter_map(|line| line.split_whitespace().next())
        .filter(|name| *name != "help")
        .collect();
    assert!(commands.len() > 15, "{commands:?}");
    for name in &commands {
        let page = session.folder().join(format!("man1/ferntast-{name}.1"));
        let text = fs::read_to_string(&page).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(text.contains(".SH"), "{name}: no manual page: {text}");
    }
    for shell in ["bash", "zsh", "fish"] {
        let text = run(&session, &["completions", shell]).success().stdout;
        for name in &commands {
            assert!(text.contains(name), "{shell} does not complete {name}");
        }
    }
}

#[test]
fn lockstep_takes_one_scenario_and_a_hand_that_there_is() {
    let session = Session::new();
    refused(
        &session,
        &["lockstep", "--hand", "crtk"],
        &["--hand scripted", "ferntast session --hand crtk"],
    );
    let two = run(&session, &["lockstep", "relay", "--scenario", "rokviss"]);
    assert_eq!(two.status.code(), Some(2), "{two:#?}");
    assert!(two.stderr.contains("cannot be used with"), "{two:#?}");
}

#[test]
fn a_lockstep_that_is_interrupted_says_so_and_leaves_a_whole_recording() {
    let session = Session::new();
    let arguments = ["lockstep", "--duration", "100000", "--record", "run"];
    let process = Process::spawn(session.ferntast(&arguments));
    let file = session.folder().join("run/run_0.mcap");
    let begun = ferntast_tests::wait_until(PATIENCE, || {
        fs::metadata(&file).is_ok_and(|file| file.len() > 1_000_000)
    });
    assert!(begun, "no recording");
    process.interrupt();
    let ended = process.wait(PATIENCE);
    assert_eq!(ended.status.code(), Some(1), "{ended:#?}");
    assert!(ended.stderr.contains("stopped after"), "{ended:#?}");
    let info = run(&session, &["bag", "info", "run", "--json"])
        .success()
        .json();
    assert_eq!(info["closed"], true, "{info:#}");
}
