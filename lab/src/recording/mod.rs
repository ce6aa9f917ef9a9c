//! Recordings as data for a fit: signals on one time base, cut into sessions.
//!
//! * The position's samples are the time base. Every other signal is
//!   interpolated linearly onto them, never across a gap of its own (more
//!   than ten of its periods). A signal much slower than the position (a
//!   temperature) stands for one of its own periods at its ends.
//! * Time is the message's header stamp where it has a `std_msgs/Header` at
//!   `header`, else the log time; a stamp of zero says that the message is not
//!   valid. In CSV it is a column \[s\].
//! * A session ends where the position, or another signal, has a gap, where
//!   `valid` is not above 0.5, and with the file. Stretches of fewer than 50
//!   samples are left out.
//! * Unevenly sampled sessions are interpolated onto their mean period.
//! * Sessions keep the time between them where files carry a date; files whose
//!   clock starts again are put one behind the other.

mod align;
mod bag;
mod error;

use std::path::{Path, PathBuf};

use ferntast_identification::{Dataset, RecordedSession};

use crate::{csv, experiment::Experiment};

pub use error::LoadError;

/// The signal that says which samples count.
const VALID: &str = "valid";

/// The tip's coordinates as signals.
const TIP_X: &str = "tip[0]";
const TIP_Y: &str = "tip[1]";

/// Times above this are dates: 1973 \[ns\] since 1970.
const DATES: i64 = 100_000_000_000_000_000;

/// One signal as it was recorded.
#[derive(Debug)]
struct Series {
    signal: String,
    file: PathBuf,
    /// \[ns\], ascending.
    times: Vec<i64>,
    values: Vec<f64>,
}

impl Series {
    fn new(signal: &str, file: &Path) -> Series {
        Series {
            signal: signal.to_owned(),
            file: file.to_owned(),
            times: Vec::new(),
            values: Vec::new(),
        }
    }

    /// Takes a sample; `place` names it in errors. A second sample of the same
    /// time is the first one sent again, and left out.
    fn push(&mut self, time: i64, value: f64, place: impl Fn() -> String) -> Result<(), LoadError> {
        if !value.is_finite() {
            return Err(LoadError::NotFinite {
                signal: self.signal.clone(),
                value,
                file: self.file.clone(),
                place: place(),
            });
        }
        match self.times.last() {
            Some(&last) if time < last => Err(LoadError::Backwards {
                signal: self.signal.clone(),
                file: self.file.clone(),
                place: place(),
                by: last.saturating_sub(time) as f64 * 1e-9,
            }),
            Some(&last) if time == last => Ok(()),
            _ => {
                self.times.push(time);
                self.values.push(value);
                Ok(())
            }
        }
    }
}

/// A signal to be read.
struct Wanted {
    signal: String,
    path: String,
}

/// Data, and what should be known of how they were read.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded {
    /// The sessions.
    pub dataset: Dataset,
    /// Sentences for the user: what was left out, what looks odd.
    pub notes: Vec<String>,
}

/// Reads what an experiment names.
///
/// # Errors
///
/// [`LoadError`]: one for each way in which recordings can be of no use.
pub fn load(experiment: &Experiment) -> Result<Loaded, LoadError> {
    for path in &experiment.held_out {
        let fitted = experiment.recordings.iter().chain(&experiment.unloaded);
        if fitted.into_iter().any(|other| same(other, path)) {
            return Err(LoadError::Both { path: path.clone() });
        }
    }
    let wanted = wanted(experiment);
    let mut notes = Vec::new();
    let mut clock = Clock::default();
    let mut read = |paths: &[PathBuf]| -> Result<Vec<RecordedSession>, LoadError> {
        let mut sessions = Vec::new();
        for path in paths {
            sessions.extend(read_file(
                experiment, path, &wanted, &mut clock, &mut notes,
            )?);
        }
        Ok(sessions)
    };
    let mut sessions = read(&experiment.recordings)?;
    let mut unloaded = read(&experiment.unloaded)?;
    unloaded
        .iter_mut()
        .for_each(|session| session.unloaded = true);
    sessions.append(&mut unloaded);
    let mut held_out = read(&experiment.held_out)?;
    sessions.sort_by(|a, b| a.start.total_cmp(&b.start));
    held_out.sort_by(|a, b| a.start.total_cmp(&b.start));
    let origin = sessions.first().map_or(0.0, |first| first.start);
    for session in sessions.iter_mut().chain(&mut held_out) {
        session.start -= origin;
    }
    check_constant(&sessions, experiment, &mut notes)?;
    Ok(Loaded {
        dataset: Dataset {
            sessions,
            held_out,
            joint: experiment.joint,
            filter: experiment.filter,
        },
        notes,
    })
}

fn same(a: &Path, b: &Path) -> bool {
    match (a.canonicalize(), b.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        _ => a == b,
    }
}

/// The signals in the order of a piece's channels.
fn wanted(experiment: &Experiment) -> Vec<Wanted> {
    let signals = &experiment.signals;
    let position = match signals.tip_y {
        Some(_) => TIP_X,
        None => "position",
    };
    let force = experiment.joint.signal("motor_torque");
    let optional = [
        (TIP_Y, &signals.tip_y),
        ("joint_torque", &signals.joint_torque),
        ("normal_force", &signals.normal_force),
        ("temperature", &signals.temperature),
        (VALID, &signals.valid),
    ];
    let mut wanted = vec![
        (position.to_owned(), signals.position.clone()),
        (force.to_owned(), signals.motor_torque.clone()),
    ];
    for (name, path) in optional {
        wanted.extend(path.iter().map(|path| (name.to_owned(), path.clone())));
    }
    let extra = signals.extra.iter();
    wanted.extend(extra.map(|(name, path)| (format!("extra.{name}"), path.clone())));
    let wanted = wanted.into_iter();
    wanted
        .map(|(signal, path)| Wanted { signal, path })
        .collect()
}

/// Where the sessions of the next file lie in time.
#[derive(Default)]
struct Clock {
    /// Start of the first file with a date \[ns\].
    first_date: Option<i64>,
    /// End of the last session \[s\].
    end: f64,
}

impl Clock {
    /// What is added to the times of a file that begins at `start` \[ns\], so
    /// that times in seconds keep their digits.
    fn offset(&mut self, start: i64) -> (i64, f64) {
        if start < DATES {
            return (start, self.end);
        }
        let origin = *self.first_date.get_or_insert(start);
        (origin, 0.0)
    }
}

fn read_file(
    experiment: &Experiment,
    path: &Path,
    wanted: &[Wanted],
    clock: &mut Clock,
    notes: &mut Vec<String>,
) -> Result<Vec<RecordedSession>, LoadError> {
    let series = read_series(experiment, path, wanted, notes)?;
    let (pieces, left_out) = align::align(path, &series)?;
    if left_out > 0 {
        notes.push(format!(
            "{}: {left_out} samples left out, in stretches of fewer than {} without a gap",
            path.display(),
            align::SHORTEST
        ));
    }
    let (origin, shift) = clock.offset(pieces.first().map_or(0, |piece| piece.start));
    let name = path.file_name().unwrap_or(path.as_os_str());
    let name = name.to_string_lossy();
    let several = pieces.len() > 1;
    let mut sessions = Vec::new();
    for (number, piece) in pieces.into_iter().enumerate() {
        let start = piece.start.saturating_sub(origin) as f64 * 1e-9 + shift;
        let mut session = RecordedSession {
            name: match several {
                true => format!("{name}, session {}", number + 1),
                false => name.to_string(),
            },
            start,
            period: piece.period,
            ..RecordedSession::default()
        };
        let mut across = Vec::new();
        for (signal, values) in wanted.iter().zip(piece.channels) {
            match signal.signal.as_str() {
                "position" | TIP_X => session.position = values,
                TIP_Y => across = values,
                "motor_torque" | "tangential_force" => session.motor_torque = values,
                "normal_force" => session.normal_force = Some(values),
                "joint_torque" => session.joint_torque = Some(values),
                "temperature" => session.temperature = Some(values),
                // What is not valid has been cut out.
                VALID => {}
                other => {
                    let name = other.strip_prefix("extra.").unwrap_or(other);
                    session.extra.insert(name.to_owned(), values);
                }
            }
        }
        if let Some(contour) = &experiment.contour {
            for (place, y) in session.position.iter_mut().zip(across) {
                *place = contour.place(*place, y);
            }
        }
        clock.end = clock.end.max(start + session.period * session.len() as f64);
        sessions.push(session);
    }
    Ok(sessions)
}

fn read_series(
    experiment: &Experiment,
    path: &Path,
    wanted: &[Wanted],
    notes: &mut Vec<String>,
) -> Result<Vec<Series>, LoadError> {
    let ending = path.extension().map(|ending| ending.to_ascii_lowercase());
    let is = |wanted: &str| ending.as_deref().is_some_and(|ending| ending == wanted);
    if is("csv") && !path.is_dir() {
        return read_csv(experiment, path, wanted);
    }
    if path.is_dir() || is("mcap") || !path.exists() {
        return bag::read(path, wanted, notes);
    }
    Err(LoadError::Kind {
        path: path.to_owned(),
    })
}

fn read_csv(
    experiment: &Experiment,
    path: &Path,
    wanted: &[Wanted],
) -> Result<Vec<Series>, LoadError> {
    let names: Vec<(&str, &str)> = wanted
        .iter()
        .map(|each| (each.signal.as_str(), each.path.as_str()))
        .collect();
    let columns = csv::read_file(path, experiment.signals.time.as_deref(), &names)?;
    let mut all = Vec::new();
    for (each, values) in wanted.iter().zip(&columns.values) {
        let mut series = Series::new(&each.signal, path);
        let rows = columns.time.iter().zip(values).zip(&columns.lines);
        for ((&time, &value), line) in rows {
            // Beyond 292 years the time saturates, and so ends the series.
            let nanos = (time * 1e9).round() as i64;
            series.push(nanos, value, || format!("line {line}"))?;
        }
        all.push(series);
    }
    Ok(all)
}

fn check_constant(
    sessions: &[RecordedSession],
    experiment: &Experiment,
    notes: &mut Vec<String>,
) -> Result<(), LoadError> {
    type Channel = fn(&RecordedSession) -> Option<&Vec<f64>>;
    let force = experiment.joint.signal("motor_torque");
    let channels: [(&str, bool, Channel); 5] = [
        ("position", true, |session| Some(&session.position)),
        (force, true, |session| Some(&session.motor_torque)),
        ("normal_force", false, |session| {
            session.normal_force.as_ref()
        }),
        ("joint_torque", true, |session| {
            session.joint_torque.as_ref()
        }),
        ("temperature", false, |session| session.temperature.as_ref()),
    ];
    for (signal, is_fatal, channel) in channels {
        let mut values = sessions.iter().filter_map(channel).flatten();
        let Some(&value) = values.next() else {
            continue;
        };
        if values.any(|&other| other != value) {
            continue;
        }
        let error = LoadError::Constant {
            signal: signal.to_owned(),
            value,
            recordings: experiment
                .recordings
                .iter()
                .map(|path| path.display().to_string())
                .collect::<Vec<_>>()
                .join(", "),
        };
        if is_fatal {
            return Err(error);
        }
        notes.push(error.to_string());
    }
    Ok(())
}
