//! Who uses whom, by `cargo metadata`.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

/// By folder, the folders of the workspace that it depends on in any way.
pub fn members(metadata: &str) -> BTreeMap<String, BTreeSet<String>> {
    let metadata: serde_json::Value = serde_json::from_str(metadata).expect("JSON of cargo");
    let list = |value: &serde_json::Value| value.as_array().cloned().unwrap_or_default();
    list(&metadata["packages"])
        .iter()
        .filter_map(|package| {
            let uses = list(&package["dependencies"])
                .iter()
                .filter_map(|used| last(used["path"].as_str()?))
                .collect();
            let manifest = Path::new(package["manifest_path"].as_str()?);
            Some((last(manifest.parent()?.to_str()?)?, uses))
        })
        .collect()
}

/// The last part of a path.
fn last(path: &str) -> Option<String> {
    Some(Path::new(path).file_name()?.to_str()?.to_owned())
}

/// What is not as the table says, in words.
pub fn wrong(
    members: &BTreeMap<String, BTreeSet<String>>,
    table: &BTreeMap<String, BTreeSet<String>>,
) -> Vec<String> {
    let mut wrong = Vec::new();
    for (name, uses) in members {
        let Some(may) = table.get(name) else {
            wrong.push(format!("{name} is missing in the table of ARCHITECTURE.md"));
            continue;
        };
        for used in uses.difference(may) {
            wrong.push(format!(
                "{name} uses {used}, which the table of ARCHITECTURE.md does not allow"
            ));
        }
    }
    wrong
}

#[cfg(test)]
mod tests {
    use super::*;

    const METADATA: &str = r#"{"packages": [
        {"manifest_path": "/w/model/Cargo.toml",
         "dependencies": [{"name": "nalgebra"}, {"name": "ferntast-bus", "path": "/w/bus", "kind": "dev"}]},
        {"manifest_path": "/w/bus/Cargo.toml", "dependencies": [{"name": "ferntast-model", "path": "/w/model"}]},
        {"manifest_path": "/w/lab/Cargo.toml", "dependencies": []}
    ]}"#;

    #[test]
    fn finds_forbidden_arrows_and_missing_rows() {
        let members = members(METADATA);
        let table = BTreeMap::from([
            ("model".into(), BTreeSet::new()),
            ("bus".into(), BTreeSet::from(["model".into()])),
        ]);
        let wrong = wrong(&members, &table);
        assert_eq!(wrong.len(), 2);
        assert!(wrong[0].starts_with("lab is missing"));
        assert!(wrong[1].starts_with("model uses bus"));
    }
}
