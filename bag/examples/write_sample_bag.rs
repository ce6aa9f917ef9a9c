//! Writes a small recording with 100 messages on every topic of the table,
//! for tests of other programs that read recordings:
//!
//! ```text
//! cargo run --release -p ferntast-bag --example write_sample_bag -- DIR [MESSAGES]
//! ```
//!
//! The same arguments give the same bytes. The summary goes to stdout as JSON.

use std::{error::Error, path::PathBuf};

#[path = "../tests/samples/mod.rs"]
mod samples;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let directory = arguments
        .next()
        .map(PathBuf::from)
        .ok_or("name the directory to write: write_sample_bag DIR [MESSAGES]")?;
    let messages = arguments.next().map_or(Ok(100), |text| text.parse())?;
    let summary = samples::write_sample_bag(&directory, messages)?;
    println!("{}", serde_json::to_string(&summary)?);
    Ok(())
}
