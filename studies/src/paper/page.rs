//! The page: one file that needs nothing else.

use ferntast_lab::report;
use serde::Serialize;

use super::item::Section;

const SECTIONS: &str = include_str!("sections.js");

#[derive(Serialize)]
struct Page<'a> {
    title: &'static str,
    subtitle: String,
    sections: &'a [Section],
}

/// The page as HTML.
///
/// # Errors
///
/// None in practice: everything on it can be written as JSON.
pub fn render(sections: &[Section], seed: u64) -> Result<String, serde_json::Error> {
    let title = "The paper, and this system beside it";
    let items = || sections.iter().flat_map(|section| &section.items);
    let page = Page {
        title,
        subtitle: format!(
            "Robotic Joints and Contact Dynamics Experiments: Lessons Learned from ROKVISS. {} of {} items hold; all from \
             recordings of the simulated arm, seed {seed}, version {}.",
            items().filter(|item| item.holds).count(),
            items().count(),
            env!("CARGO_PKG_VERSION")
        ),
        sections,
    };
    let data = serde_json::to_string(&page)?;
    Ok(report::page(title, SECTIONS, "showPaper", &data))
}
