//! What a recording has to offer as signals.

use std::path::Path;

use ferntast_bus::mcap::BagReader;
use serde::Serialize;

use super::WorkError;
use crate::{csv, experiment::ExperimentError, numbers::numbers_of};

/// The numbers of a recording that can be signals.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Offered {
    /// Message paths; of a CSV file the names of its columns.
    pub paths: Vec<String>,
    /// Of a CSV file the column that is taken for time.
    pub time: Option<String>,
    /// Whether it is a recording of ferntast's own, which needs no mapping.
    pub own: bool,
}

/// What the recording at `path` (a rosbag2 directory, `.mcap` or `.csv`) offers.
///
/// # Errors
///
/// It cannot be read.
pub fn offered(path: &Path) -> Result<Offered, WorkError> {
    let ending = path.extension().map(|ending| ending.to_ascii_lowercase());
    if ending.is_some_and(|ending| ending == "csv") && !path.is_dir() {
        let paths = csv::column_names(path)?;
        let time = csv::TIME_COLUMNS
            .iter()
            .find(|name| paths.iter().any(|column| column == *name));
        return Ok(Offered {
            time: time.map(|name| (*name).to_owned()),
            paths,
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
