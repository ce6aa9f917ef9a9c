//! The table of folders in ARCHITECTURE.md.

use std::collections::{BTreeMap, BTreeSet};

/// By folder, the folders that it may use: the table's first and third column.
/// Words that are no folder of the workspace are libraries, which are not
/// limited here.
///
/// # Panics
///
/// There is no such table.
pub fn allowed(text: &str, members: &[String]) -> BTreeMap<String, BTreeSet<String>> {
    let mut table: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    let rows = text
        .lines()
        .skip_while(|line| !(line.starts_with("| folder |") && line.contains("may use")))
        .take_while(|line| line.starts_with('|'));
    for row in rows {
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        let [folder, .., uses] = cells[..] else {
            continue;
        };
        let folder = folder.trim_matches(['`', '/']);
        if !members.iter().any(|member| member == folder) {
            continue;
        }
        let mut may = BTreeSet::new();
        for word in uses
            .split([',', ' '])
            .map(|word| word.trim_matches(['`', '/']))
        {
            if word == "all" {
                may.extend(if uses == "all" {
                    members.to_vec()
                } else {
                    table.keys().cloned().collect()
                });
            } else if members.iter().any(|member| member == word) {
                may.insert(word.to_owned());
            }
        }
        table.insert(folder.to_owned(), may);
    }
    assert!(!table.is_empty(), "no table of folders in ARCHITECTURE.md");
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "\
# Architecture
| folder | what it knows | may use |
|---|---|---|
| `model/` | physics | nalgebra |
| `bus/` | ways across | model, serde |
| `nodes/` | nodes | all above |
| `config/` | data only | – |
| `tests/` | tests | all |

| folder | other |
| `model/` | bus |
";

    #[test]
    fn reads_who_may_use_whom() {
        let members = ["model", "bus", "nodes", "tests"].map(String::from);
        let table = allowed(TEXT, &members);
        let may = |name: &str| table[name].iter().map(String::as_str).collect::<Vec<_>>();
        assert!(may("model").is_empty());
        assert_eq!(may("bus"), ["model"]);
        assert_eq!(may("nodes"), ["bus", "model"]);
        assert_eq!(may("tests"), ["bus", "model", "nodes", "tests"]);
        assert_eq!(table.len(), 4);
    }

    #[test]
    #[should_panic(expected = "no table")]
    fn misses_a_table_that_is_not_there() {
        allowed("# Architecture\n", &["model".into()]);
    }
}
