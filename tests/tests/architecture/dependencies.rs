//! What a crate reaches, by `cargo tree`.

use std::collections::{BTreeMap, BTreeSet};

/// Names of crates that a pure crate must not reach, and beginnings of names
/// (with `*`).
const IMPURE: [&str; 15] = [
    "async-std",
    "ctrlc",
    "getrandom",
    "hiroz*",
    "iceoryx2*",
    "mcap",
    "mio",
    "ros2-client",
    "rustdds",
    "signal-hook*",
    "smol",
    "socket2",
    "tempfile",
    "tokio*",
    "zenoh*",
];

/// Names of all crates that the normal dependencies of `ferntast-<name>` reach,
/// itself included.
pub fn tree(name: &str) -> BTreeSet<String> {
    let package = format!("ferntast-{name}");
    let text = super::cargo(&[
        "tree", "-p", &package, "-e", "normal", "--prefix", "none", "--format", "{p}",
    ]);
    names(&text)
}

/// Features of every crate, by name and version, with which `cargo` builds what is selected.
pub fn features(selection: &[&str]) -> BTreeMap<String, BTreeSet<String>> {
    let arguments = ["tree", "--prefix", "none", "--format", "{p}|{f}"];
    let text = super::cargo(&[&arguments, selection].concat());
    let mut found: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    // A crate that is listed again is marked by a star behind its features.
    for (name, features) in text.lines().filter_map(|line| line.split_once('|')) {
        let features = features.trim_end_matches("(*)").trim();
        let own = features.split(',').filter(|own| !own.is_empty());
        found
            .entry(name.to_owned())
            .or_default()
            .extend(own.map(str::to_owned));
    }
    found
}

/// The first word of every line.
fn names(text: &str) -> BTreeSet<String> {
    text.lines()
        .filter_map(|line| line.split_whitespace().next())
        .map(str::to_owned)
        .collect()
}

/// Those that a pure crate must not reach.
pub fn impure(tree: &BTreeSet<String>) -> Vec<String> {
    let is_impure = |name: &String| {
        let name = name.to_lowercase();
        IMPURE
            .iter()
            .any(|pattern| match pattern.strip_suffix('*') {
                Some(beginning) => name.starts_with(beginning),
                None => name == *pattern,
            })
    };
    tree.iter()
        .filter(|name| is_impure(name))
        .cloned()
        .collect()
}

#[test]
fn impure_crates_are_told_from_pure_ones() {
    let tree = names(
        "ferntast-model v0.1.0 (/somewhere)\nserde v1.0.0\nzenoh-protocol v1.0.0\nRustDDS v0.1\nmiow v1.0.0\ntokio v1.0.0 (*)\n",
    );
    assert_eq!(impure(&tree), ["RustDDS", "tokio", "zenoh-protocol"]);
    assert!(tree.contains("miow"));
}
