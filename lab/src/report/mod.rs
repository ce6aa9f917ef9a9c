//! One page that says how a model fares, with charts to zoom into. It is
//! whole in itself: it asks nothing of a network, and nothing else of the disk.
//!
//! Long curves are thinned out to what a screen can show: of every stretch
//! the smallest and the largest value stay, so that no peak is lost.

mod assemble;
mod data;
mod shades;
#[cfg(test)]
mod tests;
mod thin;

pub use assemble::{assemble, significant};
pub use data::{
    About, Bin, Candidate, Curve, Dependence, Figure, HistoryPoint, Parameter, Report, ResidualMap,
    Rival, Shade, Share, Trace, Verdict, Window,
};

const PAGE: &str = include_str!("page.html");
const STYLE: &str = include_str!("style.css");
const CHARTS: &str = include_str!("charts.js");
const KIT: &str = include_str!("kit.js");
const TREND: &str = include_str!("trend.js");
const SECTIONS: &str = include_str!("sections.js");

/// Why there is no page.
#[derive(Debug, thiserror::Error)]
#[error("the report cannot be written as JSON: {0}")]
pub struct RenderError(#[from] serde_json::Error);

/// The page as HTML.
///
/// # Errors
///
/// None in practice: everything in a report can be written as JSON.
pub fn render(report: &Report) -> Result<String, RenderError> {
    let data = serde_json::to_string(&thin::thinned(report))?;
    Ok(page(&report.title, SECTIONS, "showReport", &data))
}

/// The page of a trend as HTML.
///
/// # Errors
///
/// None in practice: everything in a trend can be written as JSON.
pub fn render_trend(trends: &impl serde::Serialize) -> Result<String, RenderError> {
    let data = serde_json::to_string(trends)?;
    Ok(page("Trend", TREND, "showTrend", &data))
}

/// A page of the same kit: `data` is JSON that the function named `show` of
/// the script `sections` takes, which has charts (`charts.js`), tables and the
/// like (`kit.js`) at hand.
pub fn page(title: &str, sections: &str, show: &str, data: &str) -> String {
    let data = in_script(data);
    let title = title.replace('&', "&amp;").replace('<', "&lt;");
    fill(
        PAGE,
        &[
            ("@TITLE@", title.as_str()),
            ("@STYLE@", STYLE),
            ("@CHARTS@", CHARTS),
            ("@KIT@", KIT),
            ("@SECTIONS@", sections),
            ("@DATA@", &data),
            ("@SHOW@", show),
        ],
    )
}

/// JSON as it may stand in a script element: nothing in it ends the element or
/// begins a comment.
fn in_script(json: &str) -> String {
    json.replace('<', "\\u003c")
}

/// `template` with its marks, in the order of `parts`, replaced by content.
fn fill(template: &str, parts: &[(&str, &str)]) -> String {
    let content: usize = parts.iter().map(|(_, content)| content.len()).sum();
    // Piece by piece, so that what is put in is never searched.
    let mut page = String::with_capacity(template.len() + content);
    let mut rest = template;
    for (mark, content) in parts {
        if let Some((before, after)) = rest.split_once(mark) {
            page.push_str(before);
            page.push_str(content);
            rest = after;
        }
    }
    page.push_str(rest);
    page
}
