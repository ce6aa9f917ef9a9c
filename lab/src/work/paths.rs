//! What a recording has to offer as signals.

use std::path::Path;

use ferntast_bag::BagReader;
use serde::Serialize;

use super::WorkError;
use crate::{
    experiment::ExperimentError,
    numbers::numbers_of,
    table::{Format, Table},
};

/// The numbers of a recording that can be signals.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Offered {
    /// Message paths; of a table the names of its columns.
    pub paths: Vec<String>,
    /// Of a table the column that is taken for time.
    pub time: Option<String>,
    /// Whether it is a recording of ferntast's own, which needs no mapping.
    pub own: bool,
}

/// What the recording at `path` (a rosbag2 directory, `.mcap` or a table) offers.
///
/// # Errors
///
/// It cannot be read.
pub fn offered(path: &Path) -> Result<Offered, WorkError> {
    if Format::of(path).is_some() && !path.is_dir() {
        let table = Table::open(path, &[])?;
        return Ok(Offered {
            time: table.time_column().map(str::to_owned),
            paths: table.names(),
            own: false,
        });
    }
    let bag = BagReader::open(path).map_err(ExperimentError::from)?;
    Ok(Offered {
        paths: numbers_of(&bag),
        time: None,
        own: bag.metadata().contains_key(crate::experiment::RECORD),
    })
}
