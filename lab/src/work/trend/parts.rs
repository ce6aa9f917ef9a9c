//! What is held beside each other: experiments, or the dates of one.

use ferntast_identification::Dataset;

use super::{super::Opened, TrendError};

/// A pause \[s\] between sessions after which another date begins.
const ANOTHER_DATE: f64 = 12.0 * 3600.0;

/// One part of the data, and the experiment that it is of.
pub(super) struct Part<'a> {
    pub(super) name: String,
    pub(super) start: Option<f64>,
    pub(super) opened: &'a Opened,
    pub(super) data: Dataset,
}

/// A whole experiment as one part.
pub(super) fn whole<'a>(opened: &&'a Opened) -> Part<'a> {
    let path = opened.experiment.path.as_ref();
    let recording = opened.experiment.recordings.first();
    let name = path.or(recording).map_or_else(
        || opened.experiment.title.clone(),
        |path| {
            let name = path.file_name().unwrap_or(path.as_os_str());
            name.to_string_lossy().into_owned()
        },
    );
    Part {
        name,
        start: opened.date,
        opened,
        data: opened.dataset.clone(),
    }
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
