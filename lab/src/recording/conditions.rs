//! Conditions that recordings were made under: as the experiment file states them, else as
//! the recordings' names tell them.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};

use crate::experiment::Experiment;

/// Words before a number that only counts.
const COUNTERS: [&str; 10] = [
    "run", "trial", "rep", "take", "part", "test", "no", "day", "session", "file",
];

/// Conditions by name.
pub(super) type Conditions = BTreeMap<String, f64>;

/// The conditions of every recording, and the names of those that are read off the
/// recordings' names.
pub(super) fn of_recordings(
    experiment: &Experiment,
) -> (BTreeMap<PathBuf, Conditions>, BTreeSet<String>) {
    let all = [
        &experiment.recordings[..],
        &experiment.unloaded[..],
        &experiment.held_out[..],
    ]
    .concat();
    let stated = &experiment.conditions;
    let known: BTreeSet<&String> = stated.values().flat_map(Conditions::keys).collect();
    let mut told: BTreeSet<String> = BTreeSet::new();
    let mut by_recording = BTreeMap::new();
    for (path, mut own) in all.iter().zip(of_names(&all)) {
        own.retain(|name, _| !known.contains(name));
        told.extend(own.keys().cloned());
        own.extend(stated.get(path).cloned().unwrap_or_default());
        by_recording.insert(path.clone(), own);
    }
    (by_recording, told)
}

/// What the names of recordings tell: a word with a number behind it (`kp100`) that all of
/// them have and that takes several values, one of them more than once; else it is a
/// running number.
fn of_names(paths: &[PathBuf]) -> Vec<Conditions> {
    let mut each: Vec<Conditions> = paths.iter().map(|path| numbers_in(path)).collect();
    let names: BTreeSet<String> = each.iter().flat_map(Conditions::keys).cloned().collect();
    for name in names {
        let values: Vec<f64> = each
            .iter()
            .filter_map(|own| own.get(&name).copied())
            .collect();
        let mut distinct = values.clone();
        distinct.sort_by(f64::total_cmp);
        distinct.dedup();
        let repeats = (2..values.len()).contains(&distinct.len());
        if values.len() < paths.len() || !repeats || COUNTERS.contains(&name.as_str()) {
            each.iter_mut().for_each(|own| {
                own.remove(&name);
            });
        }
    }
    each
}

/// The words with numbers behind them in a recording's name, `xl330_kp100_sin.csv`:
/// xl = 330, kp = 100.
fn numbers_in(path: &Path) -> Conditions {
    let stem = match path.is_dir() {
        true => path.file_name(),
        false => path.file_stem(),
    };
    let name = stem.unwrap_or_default().to_string_lossy().to_lowercase();
    let parts = name.split(|c: char| !(c.is_ascii_alphanumeric() || c == '.'));
    let word_and_number = parts.filter_map(|part| {
        let digits = part.find(|c: char| c.is_ascii_digit())?;
        let (word, number) = part.split_at(digits);
        let is_word = !word.is_empty() && word.chars().all(|c| c.is_ascii_alphabetic());
        let is_number = number.chars().all(|c| c.is_ascii_digit() || c == '.');
        (is_word && is_number).then_some((word.to_owned(), number.parse().ok()?))
    });
    word_and_number.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(names: &[&str]) -> Vec<Conditions> {
        let paths: Vec<PathBuf> = names.iter().map(PathBuf::from).collect();
        of_names(&paths)
    }

    #[test]
    fn a_gain_in_the_names_is_a_condition() {
        let found = told(&[
            "xl330_kp100_sin_sin.csv",
            "xl330_kp100_up_and_down.csv",
            "xl330_kp200_sin_sin.csv",
        ]);
        let gains = [100.0, 100.0, 200.0].map(|own| Conditions::from([("kp".to_owned(), own)]));
        assert_eq!(found, gains);
        let masses = told(&["m0.5-a.mcap", "m0.5-b.mcap", "m1.25-a.mcap"]);
        assert_eq!(masses[2]["m"], 1.25);
    }

    #[test]
    fn running_numbers_and_names_of_things_are_none() {
        let nothing = Conditions::new();
        for names in [
            ["a1.csv", "a2.csv", "a3.csv"],
            ["run1_a.csv", "run1_b.csv", "run2_a.csv"],
            ["ur10_a.csv", "ur10_b.csv", "ur10_c.csv"],
            ["kp100.csv", "kp100b.csv", "other.csv"],
            ["2024.csv", "2024.csv", "2025.csv"],
        ] {
            assert!(told(&names).iter().all(|own| *own == nothing), "{names:?}");
        }
    }
}
