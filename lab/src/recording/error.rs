//! Why recordings give no data to fit a model to.

use std::path::{Path, PathBuf};

use ferntast_bag::{OpenBagError, ReadMessageError, SelectTopicError};

use crate::{
    message_path::MessagePathError,
    schema::{DecodeError, SchemaError, SelectError},
    table::TableError,
};

/// Why recordings give no data to fit a model to.
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    /// A recording cannot be opened: not there, cut off, damaged.
    #[error(transparent)]
    Open(#[from] OpenBagError),
    /// A recording is damaged inside.
    #[error("{}: {source}; run `ferntast bag repair {}`", path.display(), path.display())]
    Read {
        /// The recording.
        path: PathBuf,
        /// Where and what.
        source: Box<ReadMessageError>,
    },
    /// Topics cannot be read together.
    #[error("{}: {source}", path.display())]
    Topics {
        /// The recording.
        path: PathBuf,
        /// What is wrong.
        source: Box<SelectTopicError>,
    },
    /// Neither a rosbag2 directory nor a file that is read.
    #[error("{} is no recording that is read: give a rosbag2 directory, an .mcap file, or a table: {}", path.display(), endings())]
    Kind {
        /// What was given.
        path: PathBuf,
    },
    /// A table.
    #[error(transparent)]
    Table(Box<TableError>),
    /// A column is in several of the files that are joined.
    #[error("signals.{signal}: column {column:?} is in {}: write {}:{column}", files.join(" and in "), files.first().map_or("", String::as_str))]
    Ambiguous {
        /// The signal.
        signal: String,
        /// The column asked for.
        column: String,
        /// The files that have it.
        files: Vec<String>,
    },
    /// Files that are joined by row have not as many rows.
    #[error("{} has {rows} rows, {} has {first_rows}: files are joined row by row only where these agree; give both a time column and write join = \"time\"", file.display(), first.display())]
    Rows {
        /// The file.
        file: PathBuf,
        /// Its rows.
        rows: u64,
        /// The first of the files.
        first: PathBuf,
        /// Its rows.
        first_rows: u64,
    },
    /// A signal's path cannot be read.
    #[error("signals.{signal}: {source}")]
    Path {
        /// The signal.
        signal: String,
        /// Where and what.
        source: Box<MessagePathError>,
    },
    /// The recording has no such topic.
    #[error("signals.{signal}: {} has no topic {topic}; numbers that it has, nearest first: {}", file.display(), list(available))]
    NoTopic {
        /// The signal.
        signal: String,
        /// The recording.
        file: PathBuf,
        /// The topic asked for.
        topic: String,
        /// Paths of numbers that there are.
        available: Vec<String>,
    },
    /// The topic has no such number.
    #[error("signals.{signal} = {path}: {source}; numbers that {} has, nearest first: {}", file.display(), list(available))]
    NoNumber {
        /// The signal.
        signal: String,
        /// Its path.
        path: String,
        /// The recording.
        file: PathBuf,
        /// What the path meets instead.
        source: Box<SelectError>,
        /// Paths of numbers that there are.
        available: Vec<String>,
    },
    /// The topic's messages cannot be understood.
    #[error("signals.{signal}: topic {topic} of {}: {source}", file.display())]
    Schema {
        /// The signal.
        signal: String,
        /// The topic.
        topic: String,
        /// The recording.
        file: PathBuf,
        /// Why not.
        source: Box<SchemaError>,
    },
    /// A message does not fit its schema.
    #[error("signals.{signal}: message {message} of topic {topic} in {}: {source}", file.display())]
    Decode {
        /// The signal.
        signal: String,
        /// The topic.
        topic: String,
        /// The recording.
        file: PathBuf,
        /// Which message of the topic, counted from 1.
        message: usize,
        /// What is wrong.
        source: DecodeError,
    },
    /// The path gives more than one number.
    #[error("signals.{signal} = {path} gives {count} numbers in message {message} of {}: choose one, by an index or by a filter such as {{name==\"joint_1\"}}", file.display())]
    Several {
        /// The signal.
        signal: String,
        /// Its path.
        path: String,
        /// The recording.
        file: PathBuf,
        /// Which message of the topic, counted from 1.
        message: usize,
        /// How many numbers.
        count: u64,
    },
    /// Not a single message has the number.
    #[error("signals.{signal} = {path}: none of the {messages} messages in {} has it{}; numbers that the file has, nearest first: {}", file.display(), longest(*length), list(available))]
    Never {
        /// The signal.
        signal: String,
        /// Its path.
        path: String,
        /// The recording.
        file: PathBuf,
        /// Messages of the topic.
        messages: usize,
        /// Length of the array that was looked into.
        length: Option<u64>,
        /// Paths of numbers that there are.
        available: Vec<String>,
    },
    /// There is nothing to read.
    #[error("signals.{signal}: topic {topic} of {} has no message", file.display())]
    Empty {
        /// The signal.
        signal: String,
        /// The topic.
        topic: String,
        /// The recording.
        file: PathBuf,
    },
    /// Not a single number.
    #[error("signals.{signal}: none of {samples} samples in {} is a number (NaN or infinite all): is it the right signal?", file.display())]
    NoNumbers {
        /// The signal.
        signal: String,
        /// The recording.
        file: PathBuf,
        /// How many there are.
        samples: usize,
    },
    /// Time runs backwards.
    #[error("time runs backwards by {by} s under signals.{signal} in {}, {place}: cut the recording there, or order it by time", file.display())]
    Backwards {
        /// The signal.
        signal: String,
        /// The recording.
        file: PathBuf,
        /// Message or line.
        place: String,
        /// How far \[s\].
        by: f64,
    },
    /// Two signals are never there at the same time.
    #[error("signals.{signal} ({from:.3} … {to:.3} s, {}) and signals.position ({position_from:.3} … {position_to:.3} s, {}) never overlap, they are {apart:.3} s apart: they must be of the same run and clock; where only the clocks differ, shift one by .@add(…) on its time", file.display(), position_file.display())]
    NoOverlap {
        /// The signal.
        signal: String,
        /// The recording.
        file: PathBuf,
        /// The position's.
        position_file: PathBuf,
        /// From the end of the earlier to the beginning of the later \[s\].
        apart: f64,
        /// Its first time \[s\].
        from: f64,
        /// Its last time \[s\].
        to: f64,
        /// The position's first time \[s\].
        position_from: f64,
        /// The position's last time \[s\].
        position_to: f64,
    },
    /// A signal does not move at all.
    #[error(
        "{}signals.{signal} is {value} {unit} in every sample of {recordings}: nothing can be learnt from a constant; is it the right signal?", of_joint(joint.as_deref())
    )]
    Constant {
        /// Of a recording of ours, whose.
        joint: Option<String>,
        /// The signal.
        signal: String,
        /// Its value.
        value: f64,
        /// Its unit; may be empty.
        unit: String,
        /// The recordings.
        recordings: String,
    },
    /// Too little is left.
    #[error("{}: {samples} samples without a gap are too few, {needed} are needed; record longer, or see that all signals are there (and valid) at the same time", file.display())]
    TooShort {
        /// The recording.
        file: PathBuf,
        /// The longest stretch with all signals \[samples\].
        samples: usize,
        /// How many would do.
        needed: usize,
    },
    /// Sampled so slowly that it must be another unit.
    #[error("signals.{signal} in {} comes every {period} s: time is in seconds here; if the column is in another unit, write time = {{ column = \"…\", unit = \"ms\" }} (or us, ns) under [signals]", file.display())]
    TooSlow {
        /// The signal.
        signal: String,
        /// The recording.
        file: PathBuf,
        /// Median interval \[s\].
        period: f64,
    },
    /// The same recording is there twice.
    #[error("{} is there twice{}: each recording counts once, under recording, unloaded or held_out; leave it out there, and of files that are joined name one first that no other recording begins with", path.display(), also(path, other))]
    Twice {
        /// The recording.
        path: PathBuf,
        /// What it is called the other time.
        other: PathBuf,
    },
    /// The same recording is fitted and held out.
    #[error("{} is both under recording and under held_out: what is held out must not be fitted", path.display())]
    Both {
        /// The recording.
        path: PathBuf,
    },
}

impl LoadError {
    /// Whether the joint stands still: its position is a constant.
    #[must_use]
    pub fn stands_still(&self) -> bool {
        matches!(self, LoadError::Constant { signal, .. } if signal == "position")
    }
}

fn of_joint(joint: Option<&str>) -> String {
    joint.map_or_else(String::new, |joint| format!("{joint}: "))
}

fn list(paths: &[String]) -> String {
    match paths {
        [] => "none".to_owned(),
        paths => paths.join(", "),
    }
}

fn also(path: &Path, other: &Path) -> String {
    match path == other {
        true => String::new(),
        false => format!(" (also as {})", other.display()),
    }
}

fn longest(length: Option<u64>) -> String {
    length.map_or(String::new(), |length| {
        format!(" (the array there has {length} elements)")
    })
}

fn endings() -> String {
    let names = crate::table::ENDINGS.iter();
    let names: Vec<String> = names.map(|(name, _)| format!(".{name}")).collect();
    names.join(", ")
}

impl From<TableError> for LoadError {
    fn from(error: TableError) -> LoadError {
        LoadError::Table(Box::new(error))
    }
}
