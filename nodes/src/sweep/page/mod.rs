//! One page with stability maps and curves. It is whole in itself: it asks
//! nothing of a network, and nothing else of the disk.

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
    // Nothing in it may end the script element or begin a comment.
    let data = data.replace('<', "\\u003c");
    let parts = [
        ("@STYLE@", STYLE),
        ("@DRAW@", DRAW),
        ("@SECTIONS@", SECTIONS),
        ("@DATA@", &data),
    ];
    // Piece by piece, so that what is put in is never searched.
    let mut page = String::with_capacity(PAGE.len() + data.len() + SECTIONS.len());
    let mut rest = PAGE;
    for (mark, content) in parts {
        if let Some((before, after)) = rest.split_once(mark) {
            page.push_str(before);
            page.push_str(content);
            rest = after;
        }
    }
    page.push_str(rest);
    Ok(page)
}
