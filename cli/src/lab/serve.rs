//! `ferntast lab serve`.

use std::{path::PathBuf, process::ExitCode, sync::atomic::Ordering, time::Duration};

use ferntast_console::{Listen, Server, server::Content};
use ferntast_nodes::process::stop_on_signals;
use serde_json::json;

use super::super::{Failure, output::print_json, page_options::PageOptions};

/// Work in the browser: map signals, compare, diagnose, add, see the error fall.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  \
    ferntast lab serve recordings\n  \
    ferntast lab serve --listen 0.0.0.0:8080 --token $(openssl rand -hex 16)")]
pub struct Arguments {
    /// Folder with recordings and experiment files.
    #[arg(default_value = ".")]
    folder: PathBuf,

    #[command(flatten)]
    page: PageOptions,
}

/// Serves until Ctrl-C.
pub fn run(arguments: Arguments, json: bool) -> Result<ExitCode, Failure> {
    let stop = stop_on_signals().map_err(Failure::failed)?;
    let page = arguments.page.console()?;
    let listen = Listen {
        address: page.listen,
        token: page.token,
    };
    let content = Content {
        shared: None,
        folder: arguments.folder,
    };
    let server = Server::start(&listen, content).map_err(Failure::refused)?;
    if json {
        print_json(&json!({ "url": server.url }))?;
    } else {
        println!("lab: {}  (Ctrl-C ends it)", server.url);
    }
    while !stop.load(Ordering::Relaxed) {
        std::thread::sleep(Duration::from_millis(50));
    }
    Ok(ExitCode::SUCCESS)
}
