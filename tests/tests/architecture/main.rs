//! The layers of ARCHITECTURE.md hold: pure crates stay pure, arrows point downwards.

mod arrows;
mod cycles;
mod dependencies;
mod modules;
mod source;
mod table;

use std::path::PathBuf;

/// The crates that must not reach a clock, a file, a socket, a thread or the middleware.
const PURE: [&str; 9] = [
    "model",
    "urdf",
    "control",
    "seal",
    "identification",
    "msgs",
    "emulation",
    "sim",
    "benches",
];

/// What reaches the simulated arm because it was chosen.
const MAY_SIMULATE: [&str; 5] = ["sim", "drivers", "studies", "cli", "python"];

/// The folder of a crate of the workspace.
fn folder(name: &str) -> PathBuf {
    ferntast_tests::root().join(name)
}

/// Output of `cargo` with these arguments, offline, in the workspace.
fn cargo(arguments: &[&str]) -> String {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = std::process::Command::new(cargo);
    command
        .args(arguments)
        .args(["--offline", "--locked"])
        .current_dir(ferntast_tests::root());
    ferntast_tests::Process::spawn(command)
        .wait(std::time::Duration::from_secs(120))
        .success()
        .stdout
}

#[test]
fn pure_crates_reach_no_middleware() {
    for name in PURE {
        let tree = dependencies::tree(name);
        assert!(
            tree.contains(&format!("ferntast-{name}")),
            "not the tree of {name}: {tree:?}"
        );
        let reached = dependencies::impure(&tree);
        assert!(
            reached.is_empty(),
            "{name} is pure, yet reaches {reached:?}; `cargo tree -p ferntast-{name} -e normal` shows by which way"
        );
    }
}

/// What works on recordings alone is compiled, linked and tested without the middleware.
#[test]
fn what_works_on_recordings_reaches_files_alone() {
    for name in ["bag", "lab", "export"] {
        assert_eq!(
            dependencies::impure(&dependencies::tree(name)),
            ["mcap"],
            "`cargo tree -p ferntast-{name} -e normal` shows by which way"
        );
    }
}

#[test]
fn the_bus_is_seen_to_reach_the_middleware() {
    // The same look at a crate that does: else the test above could not fail.
    let reached = dependencies::impure(&dependencies::tree("bus"));
    for name in ["zenoh", "ros2-client", "iceoryx2", "mcap", "tokio", "hiroz"] {
        assert!(reached.iter().any(|other| other == name), "{reached:?}");
    }
}

#[test]
fn pure_crates_name_no_clock_file_socket_or_thread() {
    for name in PURE {
        let sources = modules::sources(&folder(name).join("src"));
        assert!(!sources.is_empty(), "no sources in {name}");
        for (path, text) in sources {
            let found = source::impurities(&text)
                .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            let lines: Vec<String> = found
                .iter()
                .map(|impurity| format!("{}:{}: {}", path.display(), impurity.line, impurity.name))
                .collect();
            assert!(
                lines.is_empty(),
                "{name} is pure; take as an argument what these get by themselves:\n{}",
                lines.join("\n")
            );
        }
    }
}

#[test]
fn only_a_driver_brings_the_simulated_arm_into_a_session() {
    let members = arrows::members(&cargo(&["metadata", "--no-deps", "--format-version", "1"]));
    assert!(dependencies::tree("drivers").contains("ferntast-sim"));
    for name in members
        .keys()
        .filter(|name| !MAY_SIMULATE.contains(&name.as_str()))
    {
        let tree = dependencies::tree(name);
        for simulation in ["ferntast-sim", "ferntast-benches"] {
            let is_own = simulation.ends_with(name.as_str());
            assert!(
                is_own || !tree.contains(simulation),
                "{name} reaches {simulation}; `cargo tree -p ferntast-{name} -e normal` shows by which way"
            );
        }
    }
}

/// The README's two commands, and the wheel for Python: what one needs with other
/// features than another is compiled twice, some minutes of middleware.
#[test]
fn the_program_the_wheel_and_the_tests_share_one_build_of_their_libraries() {
    let all = dependencies::features(&["--workspace", "--edges", "normal,build,dev"]);
    for (package, manifest) in [
        ("ferntast", "cli/Cargo.toml"),
        ("ferntast-python", "python/Cargo.toml"),
    ] {
        let own = dependencies::features(&["--package", package, "--edges", "normal,build"]);
        assert!(
            own.keys().any(|name| name.starts_with("zenoh ")),
            "not the features: {own:?}"
        );
        let differ: Vec<String> = own
            .iter()
            .filter(|(name, features)| all.get(*name) != Some(features))
            .map(|(name, features)| {
                format!("{name}: {features:?}, with the tests {:?}", all.get(name))
            })
            .collect();
        assert!(
            differ.is_empty(),
            "name these features in {manifest}:\n{}",
            differ.join("\n")
        );
    }
}

#[test]
fn arrows_between_crates_follow_the_table() {
    let text = std::fs::read_to_string(folder("ARCHITECTURE.md")).expect("ARCHITECTURE.md");
    let members = arrows::members(&cargo(&["metadata", "--no-deps", "--format-version", "1"]));
    let table = table::allowed(&text, &members.keys().cloned().collect::<Vec<_>>());
    let wrong = arrows::wrong(&members, &table);
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn no_files_of_different_folders_depend_on_each_other_in_a_circle() {
    let members = arrows::members(&cargo(&["metadata", "--no-deps", "--format-version", "1"]));
    let mut lines = Vec::new();
    for name in members.keys() {
        let root = folder(name).join("src");
        let found = cycles::cycles(&root, &modules::sources(&root));
        lines.extend(found.unwrap_or_else(|error| panic!("{name}: {error}")));
    }
    assert!(
        lines.is_empty(),
        "these close a circle; move what both need to a file of its own:\n{}",
        lines.join("\n")
    );
}
