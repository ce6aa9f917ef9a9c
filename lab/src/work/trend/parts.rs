//! What is held beside each other: experiments, or the dates of one.

use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

use ferntast_identification::Dataset;

use super::{super::Opened, TrendError};
use crate::experiment::Experiment;

/// A pause \[s\] between sessions after which another date begins.
const ANOTHER_DATE: f64 = 12.0 * 3600.0;

/// One part of the data, and the experiment that it is of.
pub(super) struct Part<'a> {
    pub(super) name: String,
    pub(super) start: Option<f64>,
    pub(super) opened: &'a Opened,
    pub(super) data: Dataset,
}

/// Whole experiments as parts.
pub(super) fn whole<'a>(all: &[&'a Opened]) -> Vec<Part<'a>> {
    let paths: Vec<&Path> = all.iter().map(|own| path_of(&own.experiment)).collect();
    let parts = all.iter().zip(told_apart(&paths));
    let part = parts.map(|(opened, name)| Part {
        name,
        start: opened.date,
        opened,
        data: opened.dataset.clone(),
    });
    part.collect()
}

/// The experiment file, else the recording; of neither its title.
pub(super) fn path_of(own: &Experiment) -> &Path {
    let path = own.path.as_ref().or(own.recordings.first());
    path.map_or(Path::new(&own.title), PathBuf::as_path)
}

/// As much of the end of each path as tells them apart.
fn told_apart(paths: &[&Path]) -> Vec<String> {
    let ends = |count: usize| -> Vec<String> {
        let end = |path: &&Path| {
            let all: Vec<_> = path.components().collect();
            let rest = all.get(all.len().saturating_sub(count)..);
            let end: PathBuf = rest.unwrap_or_default().iter().collect();
            end.display().to_string()
        };
        paths.iter().map(end).collect()
    };
    let longest = paths.iter().map(|path| path.components().count()).max();
    let is_unique = |names: &[String]| names.iter().collect::<BTreeSet<_>>().len() == names.len();
    let mut counts = 1..longest.unwrap_or(1);
    let found = counts.find_map(|count| Some(ends(count)).filter(|names| is_unique(names)));
    found.unwrap_or_else(|| ends(longest.unwrap_or(1)))
}

/// The dates of one experiment; of one date its sessions.
pub(super) fn dates(opened: &Opened) -> Result<Vec<Part<'_>>, TrendError> {
    let sessions = &opened.dataset.sessions;
    let mut groups: Vec<Vec<usize>> = Vec::new();
    let mut end = f64::NEG_INFINITY;
    for (at, session) in sessions.iter().enumerate() {
        match groups.last_mut() {
            Some(last) if session.start - end < ANOTHER_DATE => last.push(at),
            _ => groups.push(vec![at]),
        }
        end = session.start + session.period * session.len() as f64;
    }
    if groups.len() < 2 {
        groups = (0..sessions.len()).map(|at| vec![at]).collect();
    }
    if groups.len() < 2 {
        return Err(TrendError::One(opened.experiment.title.clone()));
    }
    let part = |group: &Vec<usize>| {
        let own: Vec<_> = group
            .iter()
            .filter_map(|at| sessions.get(*at).cloned())
            .collect();
        let start = own.first().map_or(0.0, |session| session.start);
        let name = own
            .first()
            .map_or_else(String::new, |session| session.name.clone());
        Part {
            name,
            start: Some(opened.date.unwrap_or(0.0) + start),
            opened,
            data: Dataset {
                sessions: own
                    .into_iter()
                    .map(|mut session| {
                        session.start -= start;
                        session
                    })
                    .collect(),
                held_out: Vec::new(),
                ..opened.dataset.clone()
            },
        }
    };
    Ok(groups.iter().map(part).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_as_long_as_tells_them_apart() {
        let names = |paths: &[&str]| {
            let paths: Vec<&Path> = paths.iter().map(Path::new).collect();
            told_apart(&paths)
        };
        assert_eq!(
            names(&["a/spring.toml", "b/autumn.toml"]),
            ["spring.toml", "autumn.toml"]
        );
        assert_eq!(
            names(&["m/day_1/joint_1", "m/day_2/joint_1"]),
            ["day_1/joint_1", "day_2/joint_1"]
        );
        assert_eq!(names(&["a/d/j", "b/d/j", "k"]), ["a/d/j", "b/d/j", "k"]);
        assert_eq!(names(&["a/j", "a/j"]), ["a/j", "a/j"]);
    }
}
