//! Datasets of LeRobot, layout v3.0: recordings as episodes of `observation.state` and
//! `action` at one rate, without pictures.
//!
//! After `lerobot` 0.6 (`lerobot/datasets/{utils,feature_utils,io_utils,dataset_writer}.py`):
//! `meta/info.json`, `meta/stats.json`, `meta/tasks.parquet`,
//! `meta/episodes/chunk-000/file-000.parquet`, `data/chunk-000/file-000.parquet`.

mod episode;
mod files;
mod statistics;

use std::{fs, path::PathBuf};

use serde::Serialize;

use crate::ExportError;
pub use episode::Held;
use episode::{Episode, Parts};

/// What is to become a dataset.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// Rosbag2 directories or MCAP files: an episode each.
    pub recordings: Vec<PathBuf>,
    /// The dataset's folder, which must not exist.
    pub output: PathBuf,
    /// Frames in a second.
    pub rate_hz: f64,
    /// Message paths of `observation.state`; empty for what a session of ferntast has.
    pub state: Vec<String>,
    /// Message paths of `action`; the same.
    pub action: Vec<String>,
    /// What was done, in words.
    pub task: String,
}

/// A dataset that was written.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Dataset {
    /// Its folder.
    pub folder: PathBuf,
    /// Frames in a second.
    pub fps: u32,
    /// Episodes.
    pub episodes: usize,
    /// Frames of all.
    pub frames: usize,
    /// Names of what `observation.state` consists of.
    pub state: Vec<String>,
    /// The same of `action`.
    pub action: Vec<String>,
    /// Signals that were no numbers for some frames, and held there.
    pub held: Vec<Held>,
}

/// Writes the dataset. An episode begins where all its signals have been heard; a frame
/// has what was heard last, at its time. Where that is no finite number, it is what the frame
/// before has, and is [told](Dataset::held): a dataset has no words for "not measured", and one
/// NaN makes its statistics and whatever is trained on it NaN.
///
/// # Errors
///
/// [`ExportError`]; nothing is written before all recordings are read.
pub fn export(request: &Request) -> Result<Dataset, ExportError> {
    if request.output.exists() {
        return Err(ExportError::Exists(request.output.clone()));
    }
    let fps = whole(request.rate_hz)?;
    let mut parts: Option<Parts> = None;
    let mut episodes = Vec::new();
    let mut held = Vec::new();
    for recording in &request.recordings {
        let (own, mut episode) = Episode::read(recording, request, parts.as_ref())?;
        held.append(&mut episode.held);
        parts.get_or_insert(own);
        episodes.push(episode);
    }
    let Some(parts) = parts else {
        return Err(ExportError::Nothing {
            path: request.output.clone(),
        });
    };
    let dataset = Dataset {
        folder: request.output.clone(),
        fps,
        episodes: episodes.len(),
        frames: episodes.iter().map(Episode::frames).sum(),
        state: parts.state.names,
        action: parts.action.names,
        held,
    };
    fs::create_dir_all(&request.output).map_err(ExportError::file(&request.output))?;
    files::write(&dataset, &episodes, &request.task)?;
    Ok(dataset)
}

fn whole(rate: f64) -> Result<u32, ExportError> {
    match rate.fract() == 0.0 && (1.0..=10_000.0).contains(&rate) {
        true => Ok(rate as u32),
        false => Err(ExportError::WholeRate(rate)),
    }
}
