//! What a session's recorder wrote.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};

use ferntast_bag::BagInfo;

use super::summary::{NodeSummary, RecorderSummary};
use crate::{bridge::recorder, process::SessionContext};

/// What went into the recordings, all parts of them: that of `context` and
/// those that the page had made (`told`). Closes a part that a recorder that
/// died left open. `None` where nothing was recorded.
pub fn summarize(
    context: &SessionContext,
    nodes: &BTreeMap<String, NodeSummary>,
    told: &BTreeSet<PathBuf>,
    recorder_failed: bool,
) -> Option<RecorderSummary> {
    let recorder = nodes.get(recorder::NAME);
    let restarts = recorder.map_or(0, |recorder| recorder.restarts);
    let mut parts: Vec<PathBuf> = Vec::new();
    if let Some(bag) = &context.bag {
        parts.extend((0..=restarts).map(|generation| recorder::folder(bag, generation)));
    }
    for folder in told {
        if !parts.contains(folder) {
            parts.push(folder.clone());
        }
    }
    if parts.is_empty() {
        return None;
    }
    let mut summary = RecorderSummary {
        messages: 0,
        lost: recorder.map_or(0, |recorder| recorder.lost),
        parts: Vec::new(),
        faults: Vec::new(),
    };
    // A recorder that died before it began left no folder.
    for part in parts.iter().filter(|part| part.exists()) {
        match whole(part) {
            Ok(info) => summary.messages += info.messages,
            Err(fault) => summary.faults.push(fault),
        }
        summary.parts.push(part.display().to_string());
    }
    let had = |fault: &str| recorder.is_some_and(|node| node.faults.iter().any(|own| own == fault));
    if summary.lost > 0 {
        summary.faults.push(format!(
            "{} messages were lost on the way into the recording",
            summary.lost
        ));
    }
    if summary.parts.is_empty() {
        summary.faults.push("nothing was recorded".to_owned());
    } else if recorder_failed || had(RECORDING_FAILED) {
        summary.faults.push(
            "the recorder could not write all that it was given, see its messages above (is the disk full?)"
                .to_owned(),
        );
    }
    if restarts > 0 {
        summary.faults.push(format!(
            "the recorder died and was started again {restarts} times: what was said in between is not recorded"
        ));
    }
    Some(summary)
}

/// The fault by which the recorder says that it cannot write.
const RECORDING_FAILED: &str = ferntast_msgs::sample::Fault::RecordingFailed.name();

/// The recording at `part`, closed if it was left open.
fn whole(part: &Path) -> Result<BagInfo, String> {
    let read = ferntast_bag::info(part);
    if let Ok(info) = &read
        && info.closed
        && info.breaks.is_empty()
    {
        return read.map_err(|error| error.to_string());
    }
    let repaired = ferntast_bag::repair(part, None)
        .map_err(|error| error.to_string())
        .and_then(|_| ferntast_bag::info(part).map_err(|error| error.to_string()));
    repaired.map_err(|error| {
        let state = match read {
            Ok(_) => "was left open".to_owned(),
            Err(broken) => format!("cannot be read ({broken})"),
        };
        format!(
            "the recording {path} {state} and was not mended: {error}; then `ferntast bag repair {path}` mends it",
            path = part.display()
        )
    })
}
