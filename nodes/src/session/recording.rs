//! What a session's recorder wrote.

use std::collections::BTreeMap;

use ferntast_bus::mcap;

use super::summary::{NodeSummary, RecorderSummary};
use crate::{bridge::recorder, process::SessionContext};

/// What went into the recording, all parts of it; repairs a part that a recorder
/// that died left open.
///
/// # Errors
///
/// A part that cannot be read, as a message for people.
pub fn summarize(
    context: &SessionContext,
    nodes: &BTreeMap<String, NodeSummary>,
) -> Result<Option<RecorderSummary>, String> {
    let Some(bag) = &context.bag else {
        return Ok(None);
    };
    let recorder = nodes.get(recorder::NAME);
    let restarts = recorder.map_or(0, |recorder| recorder.restarts);
    let mut summary = RecorderSummary {
        messages: 0,
        lost: recorder.map_or(0, |recorder| recorder.lost),
        parts: Vec::new(),
    };
    for generation in 0..=restarts {
        let part = recorder::folder(bag, generation);
        if !part.exists() {
            continue; // that recorder died before it began
        }
        let info = match mcap::info(&part) {
            Ok(info) => info,
            Err(broken) => mcap::repair(&part, None)
                .map_err(|error| error.to_string())
                .and_then(|_| mcap::info(&part).map_err(|error| error.to_string()))
                .map_err(|error| {
                    format!(
                        "the recording {} cannot be read ({broken}) nor mended ({error})",
                        part.display()
                    )
                })?,
        };
        summary.messages += info.messages;
        summary.parts.push(part.display().to_string());
    }
    Ok(Some(summary))
}
