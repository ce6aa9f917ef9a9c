//! Recordings as data for a fit: signals on one time base, cut into sessions.
//!
//! * The position's samples are the time base. Every other signal is
//!   interpolated linearly onto them, never across a gap of its own (more
//!   than ten of its periods). A signal much slower than the position (a
//!   temperature) stands for one of its own periods at its ends. `valid` is a state,
//!   which may be told only when it changes: each value stands until the next, the
//!   last one to the end, and nothing is valid before the first of several.
//! * Time is the message's header stamp where it has a `std_msgs/Header` at
//!   `header`, else the log time; a stamp of zero says that the message is not
//!   valid. In a table it is a column, or comes from the rate.
//! * A session ends where the position, or another signal but `valid`, has a gap, where
//!   `valid` is not above 0.5, and with the file. Stretches that are too short for
//!   a fit are left out. Samples that are no numbers are as if they were not there;
//!   a hole of up to ten samples is bridged by a straight line, a longer one is a gap.
//! * What was not measured, or not then, is left out and told (`readings`): spikes, values sent
//!   again, times of arrival.
//! * Unevenly sampled sessions are interpolated onto their mean period.
//! * Conditions of a recording are those of the experiment file, else of the recordings'
//!   names (`kp100`, `kp200`); they go with its sessions.
//! * Sessions keep the time between them where files carry a date; files whose
//!   clock starts again are put one behind the other.

mod align;
mod bag;
mod columns;
mod conditions;
mod error;
mod plausible;
mod preview;
mod readings;
mod repeated;
mod series;
mod tally;

use std::path::{Path, PathBuf};

use ferntast_identification::{Dataset, RecordedSession};
use ferntast_msgs::counted;

use crate::{experiment::Experiment, table::Format};

pub use error::LoadError;
pub use preview::{Seen, preview};
use series::{Series, TIP_X, TIP_Y, VALID, Wanted};
pub use tally::Tally;

/// Times above this are dates: 1973 \[ns\] since 1970.
const DATES: i64 = 100_000_000_000_000_000;

/// A piece that begins later than that after the one before is a recording of its own, whose
/// clocks may have been set anew \[ns\].
const SAME_CLOCKS: i64 = 60_000_000_000;

/// Data, and what should be known of how they were read.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded {
    /// The sessions.
    pub dataset: Dataset,
    /// Sentences for the user: what was left out, what looks odd.
    pub notes: Vec<String>,
    /// What of each recording is used.
    pub tallies: Vec<Tally>,
    /// When the first session began \[s since 1970\], where recordings carry a date.
    pub date: Option<f64>,
}

/// Reads what an experiment names.
///
/// # Errors
///
/// [`LoadError`]: one for each way in which recordings can be of no use.
pub fn load(experiment: &Experiment) -> Result<Loaded, LoadError> {
    repeated::check(experiment)?;
    let wanted = wanted(experiment);
    let mut notes = Vec::new();
    let (conditions, by_name) = conditions::of_recordings(experiment);
    for name in by_name {
        notes.push(format!(
            "{name} differs in the names of the recordings: it is taken for a condition, as what varies together tells; state it as conditions = {{ {name} = … }} or call the recordings otherwise"
        ));
    }
    let mut clock = Clock::default();
    let mut tallies = Vec::new();
    plausible::check_names(experiment, &mut notes);
    let mut read = |paths: &[PathBuf]| -> Result<Vec<RecordedSession>, LoadError> {
        let mut sessions = Vec::new();
        for path in paths {
            let (mut own, tally) = read_file(experiment, path, &wanted, &mut clock, &mut notes)?;
            for session in &mut own {
                session.conditions = conditions.get(path).cloned().unwrap_or_default();
                session.torque_is_modelled = experiment.torque_is_modelled;
            }
            sessions.extend(own);
            tallies.push(tally);
        }
        // One that is too short is left out, but not the last one.
        match (sessions.is_empty(), tallies.last()) {
            (true, Some(tally)) if !paths.is_empty() => Err(LoadError::TooShort {
                file: tally.file.clone(),
                samples: tally.longest,
                needed: align::SHORTEST,
            }),
            _ => Ok(sessions),
        }
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
    if let (Some(_), Some(first)) = (clock.first_date, clock.undated.first()) {
        let file = first.display();
        let others = match clock.undated.len() - 1 {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        notes.push(format!(
            "{file}{others}: no date, while other recordings have one: taken to follow these; state it as {{ file = …, date = 2026-03-09T14:30:00 }}"
        ));
    }
    Ok(Loaded {
        dataset: Dataset {
            sessions,
            held_out,
            joint: experiment.joint,
            filter: experiment.filter,
        },
        notes,
        tallies,
        date: clock.first_date.map(|date| date as f64 * 1e-9 + origin),
    })
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
    let wanted = wanted.into_iter().map(|(signal, path)| {
        let key = match signal.as_str() {
            "tangential_force" => "motor_torque",
            key => key,
        };
        // The unit of an extra signal is for people, but where it is that of a joint.
        let is_of_people = key.starts_with("extra.") && experiment.arm.is_none();
        let unit = signals.unit(key).filter(|_| !is_of_people);
        Wanted {
            unit,
            time: signals.times.get(key).cloned(),
            signal: match (&experiment.arm, signal.strip_prefix("extra.")) {
                (Some(_), Some(of_joint)) => of_joint.to_owned(),
                _ => signal,
            },
            path,
        }
    });
    wanted.collect()
}

/// Where the sessions of the next file lie in time.
#[derive(Default)]
struct Clock {
    /// Start of the first file with a date \[ns\].
    first_date: Option<i64>,
    /// End of the last session \[s\].
    end: f64,
    /// Files without a date.
    undated: Vec<PathBuf>,
}

impl Clock {
    /// What is taken from the times \[ns\] of the file at `path`, which begins at `start`, and what is
    /// added then \[s\], so that times in seconds keep their digits; `stated` is the date that it
    /// began at.
    fn offset(&mut self, path: &Path, start: i64, stated: Option<i64>) -> (i64, f64) {
        if let Some(began) = stated {
            let first = *self.first_date.get_or_insert(began);
            return (start, began.saturating_sub(first) as f64 * 1e-9);
        }
        if start < DATES {
            self.undated.push(path.to_owned());
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
) -> Result<(Vec<RecordedSession>, Tally), LoadError> {
    let (mut series, mut tally) = read_series(experiment, path, wanted, notes)?;
    for own in &series {
        if own.times.is_empty() {
            return Err(LoadError::NoNumbers {
                signal: own.signal.clone(),
                file: own.file.clone(),
                samples: own.missing,
            });
        }
    }
    if !experiment.reading.as_recorded {
        notes.extend(readings::set_clock(&mut series));
    }
    series.iter_mut().for_each(Series::drop_repeated);
    if let Some(position) = series.first() {
        tally.without_number = position.missing;
        tally.repeated_time = position.repeated;
    }
    tell_holes(&series, notes);
    readings::clean(experiment, &mut series, &mut tally, notes);
    plausible::check(experiment, &series, notes);
    let pieces = align::align(path, &series, &mut tally)?;
    drop(series);
    if tally.short_stretches > 0 {
        notes.push(format!(
            "{}: {} samples left out, in {} of fewer than {} without a gap",
            path.display(),
            tally.in_short_stretches,
            counted(tally.short_stretches, "stretch"),
            align::SHORTEST
        ));
    }
    let start = pieces.first().map_or(0, |piece| piece.start);
    let stated = experiment.dates.get(path).copied();
    let (origin, shift) = clock.offset(path, start, stated);
    let name = path.file_name().unwrap_or(path.as_os_str());
    let name = name.to_string_lossy();
    let several = pieces.len() > 1;
    let mut sessions = Vec::new();
    let (mut began, mut before) = (start, start);
    for (number, piece) in pieces.into_iter().enumerate() {
        if piece.start.saturating_sub(before) > SAME_CLOCKS {
            began = piece.start;
        }
        before = piece.end();
        let start = piece.start.saturating_sub(origin) as f64 * 1e-9 + shift;
        let mut session = RecordedSession {
            name: match several {
                true => format!("{name}, session {}", number + 1),
                false => name.to_string(),
            },
            start,
            into_recording: piece.start.saturating_sub(began) as f64 * 1e-9,
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
    Ok((sessions, tally))
}

/// Tells where samples are no numbers, or have no time of their own.
fn tell_holes(series: &[Series], notes: &mut Vec<String>) {
    for own in series {
        let (signal, file) = (&own.signal, own.file.display());
        if let Some(first) = &own.first_missing {
            let consequence = match signal == VALID {
                true => "what was said before them holds on",
                false => "up to ten in a row are bridged, more are cut out",
            };
            notes.push(format!(
                "{file}: signals.{signal} has {} samples without a number or time, the first in {first}: {consequence}",
                own.missing
            ));
        }
        if own.repeated > 0 {
            notes.push(format!(
                "{file}: {} samples of signals.{signal} have the time of the one before and are left out; if many, the time has too few digits: give rate_hz instead",
                own.repeated
            ));
        }
    }
}

fn read_series(
    experiment: &Experiment,
    path: &Path,
    wanted: &[Wanted],
    notes: &mut Vec<String>,
) -> Result<(Vec<Series>, Tally), LoadError> {
    if Format::of(path).is_some() && !path.is_dir() {
        return columns::read(experiment, path, wanted, notes);
    }
    let ending = path.extension().map(|ending| ending.to_ascii_lowercase());
    let is_mcap = ending.is_some_and(|ending| ending == "mcap");
    if path.is_dir() || is_mcap || !path.exists() {
        return bag::read(path, wanted, notes);
    }
    Err(LoadError::Kind {
        path: path.to_owned(),
    })
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
        let of_recording = experiment.path.is_none();
        let error = LoadError::Constant {
            joint: of_recording.then(|| experiment.title.clone()),
            signal: signal.to_owned(),
            value,
            unit: experiment.unit_of(signal),
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
