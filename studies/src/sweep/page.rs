//! One page with stability maps and curves. It is whole in itself: it asks
//! nothing of a network, and nothing else of the disk.

use ferntast_lab::report;
use serde::Serialize;

use super::{LargestStable, Row, SweepConfig, largest_stable};

const TITLE: &str = "Delay laws over delay, jitter and loss";
const SECTIONS: &str = include_str!("sections.js");

/// Why there is no page.
#[derive(Debug, thiserror::Error)]
#[error("the sweep cannot be written as JSON: {0}")]
pub struct RenderError(#[from] serde_json::Error);

#[derive(Serialize)]
struct Content<'a> {
    title: &'static str,
    description: &'a str,
    rows: &'a [Row],
    largest_stable: Vec<LargestStable<'a>>,
}

/// The page as HTML.
///
/// # Errors
///
/// None in practice: every row can be written as JSON.
pub fn render(config: &SweepConfig, rows: &[Row]) -> Result<String, RenderError> {
    let data = serde_json::to_string(&Content {
        title: TITLE,
        description: &config.description,
        rows,
        largest_stable: largest_stable(rows),
    })?;
    Ok(report::page(TITLE, SECTIONS, "showSweep", &data))
}
