//! Why a table gives no signals.

use std::{io, path::PathBuf};

use super::format::TIME_COLUMNS;
use crate::message_path::MessagePathError;

/// Why a table gives no signals.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// The file cannot be opened or read.
    #[error("cannot read {}: {source}", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The file is not what its name says: lines of different length, damaged.
    #[error("{}: {reason}; correct that, or export the file again", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// Where, and what is wrong there.
        reason: String,
    },
    /// No row of numbers.
    #[error("{} is empty: it needs rows of numbers, and a line that names the columns or `columns = [\"t\", \"q\", …]` in the experiment file", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// Names were given for another number of columns.
    #[error("columns: {given} names, where {} has {there} columns: name each", path.display())]
    Names {
        /// The file.
        path: PathBuf,
        /// How many names.
        given: usize,
        /// How many columns.
        there: usize,
    },
    /// No column is time.
    #[error("{}: no column is time: name one {}, give signals.time, or rate_hz where there is none; the columns are: {}", path.display(), TIME_COLUMNS.join(", "), columns.join(", "))]
    NoTime {
        /// The file.
        path: PathBuf,
        /// The columns that there are.
        columns: Vec<String>,
    },
    /// There is no such column.
    #[error("signals.{signal}: {} has no column {column:?}; its columns, nearest first: {}", path.display(), columns.join(", "))]
    NoColumn {
        /// The signal.
        signal: String,
        /// The file.
        path: PathBuf,
        /// The column asked for.
        column: String,
        /// The columns that there are.
        columns: Vec<String>,
    },
    /// Two columns of that name.
    #[error("signals.{signal}: {} has more than one column {column:?}: rename one, or name all by `columns` in the experiment file", path.display())]
    Twice {
        /// The signal.
        signal: String,
        /// The file.
        path: PathBuf,
        /// The column asked for.
        column: String,
    },
    /// The function behind the column's name is none.
    #[error("signals.{signal}: {source}")]
    Function {
        /// The signal.
        signal: String,
        /// What is wrong.
        source: MessagePathError,
    },
    /// A cell holds words.
    #[error("{}, {place}: column {column:?} (signals.{signal}) holds {text:?}, not a number; fill it or leave the line out", path.display())]
    NotANumber {
        /// The signal.
        signal: String,
        /// The file.
        path: PathBuf,
        /// The line or row, counted from 1.
        place: String,
        /// The column.
        column: String,
        /// What stands there.
        text: String,
    },
    /// A column without a single number.
    #[error("signals.{signal}: column {column:?} of {} holds no number in any of {rows} rows; is it the right one?", path.display())]
    NoNumber {
        /// The signal.
        signal: String,
        /// The file.
        path: PathBuf,
        /// The column.
        column: String,
        /// How many rows there are.
        rows: u64,
    },
}
