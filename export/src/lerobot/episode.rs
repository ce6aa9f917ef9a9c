//! A recording as frames.

use std::path::{Path, PathBuf};

use ferntast_bag::BagReader;
use serde::Serialize;

use super::Request;
use crate::{
    ExportError,
    error::nearest,
    joined::joined,
    table::Table,
    topic::{TopicNumbers, topics_of},
};

/// What a session of ferntast has as its state, by the beginnings of message paths …
const STATE: [&str; 5] = [
    "/follower/measured_js.position[",
    "/follower/measured_js.velocity[",
    "/follower/measured_js.effort[",
    "/follower/contact_cf.wrench.force.x",
    "/follower/contact_cf.wrench.force.z",
];

/// … and as its action.
const ACTION: [&str; 2] = [
    "/follower/servo_cp.pose.position.x",
    "/follower/servo_cp.pose.position.y",
];

/// Numbers that make one vector.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Part {
    /// Their message paths.
    paths: Vec<String>,
    /// Names of their columns.
    pub names: Vec<String>,
}

/// What a frame consists of.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parts {
    /// `observation.state`.
    pub state: Part,
    /// `action`.
    pub action: Part,
}

/// A signal that was no number in some frames of a recording, which have the one before.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Held {
    /// The recording.
    pub recording: PathBuf,
    /// The signal.
    pub signal: String,
    /// How many frames.
    pub frames: usize,
    /// The first of them, from the recording's start \[s\].
    pub first_s: f64,
}

/// Frames of one recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Episode {
    /// `observation.state` of each frame.
    pub state: Vec<Vec<f32>>,
    /// `action` of each frame.
    pub action: Vec<Vec<f32>>,
    /// What was no number after the first frame.
    pub held: Vec<Held>,
}

impl Episode {
    /// How many.
    pub fn frames(&self) -> usize {
        self.state.len()
    }

    /// Reads the recording at `path`, with the same parts as those before it.
    ///
    /// # Errors
    ///
    /// It cannot be read, or has not what is asked for.
    pub fn read(
        path: &Path,
        request: &Request,
        before: Option<&Parts>,
    ) -> Result<(Parts, Episode), ExportError> {
        let bag = BagReader::open(path)?;
        let topics = topics_of(path, &bag, &[])?;
        let parts = match before {
            Some(parts) => Parts {
                state: part(path, &topics, &parts.state.paths, &[])?,
                action: part(path, &topics, &parts.action.paths, &[])?,
            },
            None => Parts {
                state: part(path, &topics, &request.state, &STATE)?,
                action: part(path, &topics, &request.action, &ACTION)?,
            },
        };
        let wanted = |topic: &TopicNumbers| {
            let all = parts.state.paths.iter().chain(&parts.action.paths);
            all.into_iter()
                .any(|own| topic.paths.iter().any(|path| path.to_string() == *own))
        };
        let topics = topics.into_iter().filter(wanted).collect();
        let table = joined(path, &bag, topics, request.rate_hz)?;
        let vectors = |part: &Part| vectors(&table, &part.names);
        let (state, action) = (vectors(&parts.state), vectors(&parts.action));
        let is_whole = |row: &Vec<f32>| row.iter().all(|value| value.is_finite());
        let first = state
            .iter()
            .zip(&action)
            .position(|(state, action)| is_whole(state) && is_whole(action));
        let Some(first) = first else {
            let names = [parts.state.names.as_slice(), &parts.action.names].concat();
            return Err(ExportError::Never {
                path: path.to_owned(),
                signals: names.join(", "),
            });
        };
        let mut held = Vec::new();
        let mut rest = |rows: Vec<Vec<f32>>, names: &[String]| {
            let mut rows: Vec<Vec<f32>> = rows.into_iter().skip(first).collect();
            for (signal, (row, frames)) in names.iter().zip(hold(&mut rows)) {
                if frames > 0 {
                    held.push(Held {
                        recording: path.to_owned(),
                        signal: signal.clone(),
                        frames,
                        first_s: (first + row) as f64 / request.rate_hz,
                    });
                }
            }
            rows
        };
        let (state, action) = (
            rest(state, &parts.state.names),
            rest(action, &parts.action.names),
        );
        Ok((
            parts,
            Episode {
                state,
                action,
                held,
            },
        ))
    }
}

/// The numbers at `said`, else those that begin as `usual` ones.
fn part(
    path: &Path,
    topics: &[TopicNumbers],
    said: &[String],
    usual: &[&str],
) -> Result<Part, ExportError> {
    let all: Vec<(String, String)> = topics
        .iter()
        .flat_map(|topic| {
            let columns = topic.paths.iter().zip(&topic.columns);
            columns.map(|(path, column)| (path.to_string(), format!("{}.{column}", topic.name)))
        })
        .collect();
    let mut part = Part::default();
    let mut take = |(path, name): &(String, String)| {
        part.paths.push(path.clone());
        part.names.push(name.clone());
    };
    for said in said {
        let found = all.iter().find(|(path, _)| path == said);
        take(found.ok_or_else(|| ExportError::NoNumber {
            path: path.to_owned(),
            name: said.clone(),
            alike: nearest(said, all.iter().map(|(path, _)| path.as_str())),
        })?);
    }
    if said.is_empty() {
        for usual in usual {
            all.iter()
                .filter(|(path, _)| path.starts_with(usual))
                .for_each(&mut take);
        }
    }
    match part.paths.is_empty() {
        true => Err(ExportError::Unsaid {
            path: path.to_owned(),
        }),
        false => Ok(part),
    }
}

/// Row by row, the numbers in the columns of those names.
fn vectors(table: &Table, names: &[String]) -> Vec<Vec<f32>> {
    let columns: Vec<&Vec<f64>> = names
        .iter()
        .filter_map(|name| table.iter().find(|column| column.name == *name))
        .map(|column| &column.values)
        .collect();
    let rows = columns.first().map_or(0, |column| column.len());
    let row = |row: usize| {
        let values = columns.iter().filter_map(|column| column.get(row));
        values.map(|value| *value as f32).collect()
    };
    (0..rows).map(row).collect()
}

/// Puts what stands in the row before in the place of what is no finite number: whoever learns
/// of a dataset takes none. Gives for each column the first such row, and how many there are.
fn hold(rows: &mut [Vec<f32>]) -> Vec<(usize, usize)> {
    let mut told = vec![(0, 0); rows.first().map_or(0, Vec::len)];
    for at in 1..rows.len() {
        let (done, rest) = rows.split_at_mut(at);
        let (Some(before), Some(row)) = (done.last(), rest.first_mut()) else {
            continue;
        };
        for ((value, before), (first, count)) in row.iter_mut().zip(before).zip(&mut told) {
            if value.is_finite() {
                continue;
            }
            *value = *before;
            if *count == 0 {
                *first = at;
            }
            *count += 1;
        }
    }
    told
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_number_is_held_and_counted() {
        let mut rows = vec![
            vec![1.0, 5.0, 9.0],
            vec![f32::NAN, 6.0, 9.0],
            vec![f32::INFINITY, f32::NAN, 9.0],
            vec![4.0, 8.0, 9.0],
            vec![f32::NAN, 8.0, 9.0],
        ];
        assert_eq!(hold(&mut rows), [(1, 3), (2, 1), (0, 0)]);
        let expected = [
            [1.0, 5.0, 9.0],
            [1.0, 6.0, 9.0],
            [1.0, 6.0, 9.0],
            [4.0, 8.0, 9.0],
            [4.0, 8.0, 9.0],
        ];
        assert_eq!(rows, expected.map(Vec::from));
        assert!(hold(&mut []).is_empty());
    }
}
