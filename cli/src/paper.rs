//! `ferntast paper`.

use std::{path::PathBuf, process::ExitCode, sync::atomic::AtomicU64, sync::atomic::Ordering};

use ferntast_lab::report::significant;
use ferntast_studies::paper::{self, Item, PaperError};
use indicatif::{ProgressBar, ProgressStyle};

use super::{Failure, output::print_json};

/// Run the paper's experiments, and hold its table and figures against what the recordings say.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "The page is DIR/paper.html, the recordings are below DIR/recordings:\n  \
    ferntast paper -o paper\n\
    Exit code 1 says that an item does not hold."
)]
pub struct Arguments {
    /// Folder for page and recordings; its `recordings` must not exist yet.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,

    /// Seed of all sensors' noise.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

fn failure(error: PaperError) -> Failure {
    match error {
        PaperError::Config(_) | PaperError::Parameter(_) | PaperError::Write { .. } => {
            Failure::refused(error)
        }
        _ => Failure::failed(error),
    }
}

/// Runs it.
pub fn run(arguments: &Arguments, json: bool) -> Result<ExitCode, Failure> {
    let recordings = arguments.output.join("recordings");
    if recordings.exists() {
        return Err(Failure::refused(format!(
            "{} exists; remove it or choose another folder",
            recordings.display()
        )));
    }
    let duration = paper::duration().map_err(failure)?;
    let bar = ProgressBar::new(duration.ceil() as u64);
    if let Ok(style) =
        ProgressStyle::with_template("{bar:30} {pos}/{len} s of virtual time, {eta} left")
    {
        bar.set_style(style);
    }
    let done = AtomicU64::new(0);
    let evidence = paper::collect(&recordings, arguments.seed, &|slice| {
        let passed = (slice * 1e3) as u64;
        let total = done.fetch_add(passed, Ordering::Relaxed) + passed;
        bar.set_position(total / 1000);
    });
    bar.finish_and_clear();
    let sections = paper::judge(&evidence.map_err(failure)?);
    let page = arguments.output.join("paper.html");
    let text = paper::render(&sections, arguments.seed).map_err(Failure::failed)?;
    std::fs::write(&page, text).map_err(|source| {
        failure(PaperError::Write {
            path: page.clone(),
            source,
        })
    })?;
    let items: Vec<&Item> = sections.iter().flat_map(|section| &section.items).collect();
    if json {
        print_json(&items)?;
    } else {
        table(&items);
        println!("page: {}", page.display());
    }
    let all = items.iter().all(|item| item.holds);
    Ok(ExitCode::from(u8::from(!all)))
}

fn table(items: &[&Item]) {
    let number = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), significant);
    let width = |of: fn(&Item) -> &str, head: &str| {
        let widths = items.iter().map(|item| of(item).chars().count());
        widths.chain([head.len()]).max().unwrap_or(0)
    };
    let name = width(|item| &item.item, "item");
    let unit = width(|item| item.unit, "unit");
    println!(
        "{:<name$} {:>10} {:>10} {:>10}  {:<unit$}  holds",
        "item", "paper", "here", "± error", "unit"
    );
    for item in items {
        println!(
            "{:<name$} {:>10} {:>10} {:>10}  {:<unit$}  {}  {}",
            item.item,
            // As the paper has it.
            item.paper
                .map_or_else(|| "–".to_owned(), |value| value.to_string()),
            number(item.here),
            number(item.std_error),
            item.unit,
            if item.holds { "yes" } else { "NO " },
            item.criterion
        );
    }
    let holding = items.iter().filter(|item| item.holds).count();
    println!("{holding} of {} hold", items.len());
}
