//! What is held beside each other: experiments, or the dates of one.

use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

use ferntast_identification::{
    Dataset,
    arm::{ArmDataset, ArmSession},
};

use super::{
    super::{Opened, OpenedArm},
    TrendError,
};
use crate::experiment::Experiment;

/// A pause \[s\] between sessions after which another date begins.
const ANOTHER_DATE: f64 = 12.0 * 3600.0;

/// One part of the data, and the experiment that it is of.
pub(super) struct Part<'a, T: Parted> {
    pub(super) name: String,
    pub(super) start: Option<f64>,
    pub(super) opened: &'a T,
    pub(super) data: T::Data,
}

/// An experiment whose recordings are read, of a joint or of an arm.
pub(super) trait Parted {
    /// Its sessions.
    type Data: Clone;

    fn experiment(&self) -> &Experiment;
    /// When the first session began \[s since 1970\], where recordings carry a date.
    fn date(&self) -> Option<f64>;
    fn data(&self) -> &Self::Data;
    fn spans(&self) -> Vec<Span>;
    /// Only the sessions with these numbers, the first of which begins at `start`.
    fn only(&self, sessions: &[usize], start: f64) -> Self::Data;
}

/// A session in time \[s\].
pub(super) struct Span {
    name: String,
    start: f64,
    end: f64,
}

impl Parted for Opened {
    type Data = Dataset;

    fn experiment(&self) -> &Experiment {
        &self.experiment
    }

    fn date(&self) -> Option<f64> {
        self.date
    }

    fn data(&self) -> &Dataset {
        &self.dataset
    }

    fn spans(&self) -> Vec<Span> {
        let each = self.dataset.sessions.iter().map(|own| Span {
            name: own.name.clone(),
            start: own.start,
            end: own.start + own.period * own.len() as f64,
        });
        each.collect()
    }

    fn only(&self, sessions: &[usize], start: f64) -> Dataset {
        let own = sessions.iter().filter_map(|at| {
            let mut session = self.dataset.sessions.get(*at).cloned()?;
            session.start -= start;
            Some(session)
        });
        Dataset {
            sessions: own.collect(),
            held_out: Vec::new(),
            ..self.dataset.clone()
        }
    }
}

impl Parted for OpenedArm {
    type Data = ArmDataset;

    fn experiment(&self) -> &Experiment {
        &self.experiment
    }

    fn date(&self) -> Option<f64> {
        self.date
    }

    fn data(&self) -> &ArmDataset {
        &self.dataset
    }

    fn spans(&self) -> Vec<Span> {
        let samples = |own: &ArmSession| own.position.first().map_or(0, Vec::len);
        let each = self.dataset.sessions.iter().map(|own| Span {
            name: own.name.clone(),
            start: own.start,
            end: own.start + own.period * samples(own) as f64,
        });
        each.collect()
    }

    fn only(&self, sessions: &[usize], start: f64) -> ArmDataset {
        let own = sessions.iter().filter_map(|at| {
            let mut session = self.dataset.sessions.get(*at).cloned()?;
            session.start -= start;
            Some(session)
        });
        ArmDataset {
            sessions: own.collect(),
            held_out: Vec::new(),
            ..self.dataset.clone()
        }
    }
}

/// What is held beside each other: whole experiments, or of one its dates.
pub(super) fn parts<'a, T: Parted>(all: &[&'a T]) -> Result<Vec<Part<'a, T>>, TrendError> {
    match all {
        [one] => dates(*one),
        several => Ok(whole(several)),
    }
}

/// Whole experiments as parts.
fn whole<'a, T: Parted>(all: &[&'a T]) -> Vec<Part<'a, T>> {
    let paths: Vec<&Path> = all.iter().map(|own| path_of(own.experiment())).collect();
    let parts = all.iter().zip(told_apart(&paths));
    let part = parts.map(|(opened, name)| Part {
        name,
        start: opened.date(),
        opened: *opened,
        data: opened.data().clone(),
    });
    part.collect()
}

/// Days from the first part that has a date to this one.
pub(super) fn days<T: Parted>(parts: &[Part<'_, T>], part: &Part<'_, T>) -> Option<f64> {
    let begin = parts.iter().find_map(|own| own.start)?;
    part.start.map(|own| (own - begin) / 86_400.0)
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
fn dates<T: Parted>(opened: &T) -> Result<Vec<Part<'_, T>>, TrendError> {
    let spans = opened.spans();
    let mut groups: Vec<Vec<usize>> = Vec::new();
    let mut end = f64::NEG_INFINITY;
    for (at, session) in spans.iter().enumerate() {
        match groups.last_mut() {
            Some(last) if session.start - end < ANOTHER_DATE => last.push(at),
            _ => groups.push(vec![at]),
        }
        end = session.end;
    }
    if groups.len() < 2 {
        groups = (0..spans.len()).map(|at| vec![at]).collect();
    }
    if groups.len() < 2 {
        return Err(TrendError::One(opened.experiment().title.clone()));
    }
    let part = |group: &Vec<usize>| {
        let first = group.first().and_then(|at| spans.get(*at));
        let start = first.map_or(0.0, |session| session.start);
        Part {
            name: first.map_or_else(String::new, |session| session.name.clone()),
            start: Some(opened.date().unwrap_or(0.0) + start),
            opened,
            data: opened.only(group, start),
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
