//! How the files of an experiment are read.

use serde::{Deserialize, Serialize};

use super::ExperimentError;

/// How tables are read, where they do not say it themselves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reading {
    /// Names of the columns: none, one list for all files, or of files that are
    /// joined one each.
    pub columns: Vec<Vec<String>>,
    /// Rows in a second, in place of a column that is time \[Hz\].
    pub rate_hz: Option<f64>,
    /// How files are joined; `None`: by time where each has one, else by row.
    pub join: Option<Join>,
    /// Whether readings that can hardly be right are kept.
    pub as_recorded: bool,
}

/// Which readings are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Readings {
    /// Those that can be right.
    Plausible,
    /// All as they are.
    AsRecorded,
}

/// How files that were recorded together are joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Join {
    /// Signals of all files onto the times of the position.
    Time,
    /// The n-th row of each file belongs to the n-th of the first.
    Row,
}

/// Names of all columns; of joined files a list each.
#[derive(Debug, Deserialize)]
#[serde(
    untagged,
    expecting = "expected names of columns, [\"t\", \"q\", \"i\"], or of files that are joined a list of them each"
)]
pub(super) enum ColumnNames {
    Same(Vec<String>),
    Each(Vec<Vec<String>>),
}

impl Default for ColumnNames {
    fn default() -> ColumnNames {
        ColumnNames::Same(Vec::new())
    }
}

/// What the file says of that.
pub(super) fn reading(
    columns: ColumnNames,
    rate_hz: Option<f64>,
    join: Option<Join>,
    readings: Option<Readings>,
    refuse: &impl Fn(&str, String) -> ExperimentError,
) -> Result<Reading, ExperimentError> {
    if let Some(rate) = rate_hz
        && !(1e-3..=1e8).contains(&rate)
    {
        let reason = format!("{rate} is outside 0.001 … 100000000 Hz");
        return Err(refuse("rate_hz", reason));
    }
    let columns = match columns {
        ColumnNames::Same(names) if names.is_empty() => Vec::new(),
        ColumnNames::Same(names) => vec![names],
        ColumnNames::Each(lists) => lists,
    };
    Ok(Reading {
        columns,
        rate_hz,
        join,
        as_recorded: readings == Some(Readings::AsRecorded),
    })
}
