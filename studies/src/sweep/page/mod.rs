//! One page with stability maps and curves. It is whole in itself: it asks
//! nothing of a network, and nothing else of the disk.

use ferntast_lab::report::{fill, in_script};
use serde::Serialize;

use super::{LargestStable, Row, SweepConfig, largest_stable};

const PAGE: &str = include_str!("page.html");
const STYLE: &str = include_str!("style.css");
const DRAW: &str = include_str!("draw.js");
const SECTIONS: &str = include_str!("sections.js");

/// Why there is no page.
#[derive(Debug, thiserror::Error)]
#[error("the sweep cannot be written as JSON: {0}")]
pub struct RenderError(#[from] serde_json::Error);

#[derive(Serialize)]
struct Content<'a> {
    description: &'a str,
    rows: &'a [Row],
    largest_stable: Vec<LargestStable>,
}

/// The page as HTML.
///
/// # Errors
///
/// None in practice: every row can be written as JSON.
pub fn render(config: &SweepConfig, rows: &[Row]) -> Result<String, RenderError> {
    let data = serde_json::to_string(&Content {
        description: &config.description,
        rows,
        largest_stable: largest_stable(rows),
    })?;
    Ok(fill(
        PAGE,
        &[
            ("@STYLE@", STYLE),
            ("@DRAW@", DRAW),
            ("@SECTIONS@", SECTIONS),
            ("@DATA@", &in_script(&data)),
        ],
    ))
}
