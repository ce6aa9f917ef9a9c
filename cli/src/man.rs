//! `ferntast man`.

use std::{fs, path::PathBuf, process::ExitCode};

use clap::Command;

use super::{Failure, output::print_json};

/// Write the manual pages, one a command.
#[derive(Debug, clap::Args)]
#[command(after_help = "For this user (man finds pages there by itself):\n  \
    ferntast man -o ~/.local/share/man/man1\n  \
    man ferntast-session")]
pub struct Arguments {
    /// Folder for the pages; is made if need be, pages of the same name are replaced.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

/// Runs it; `command` is the whole command line.
pub fn run(arguments: &Arguments, command: Command, json: bool) -> Result<ExitCode, Failure> {
    let folder = &arguments.output;
    let told = |error| Failure::refused(format!("{}: {error}", folder.display()));
    fs::create_dir_all(folder).map_err(told)?;
    clap_mangen::generate_to(command, folder).map_err(told)?;
    match json {
        true => print_json(&serde_json::json!({ "folder": folder }))?,
        false => println!("{}", folder.join("ferntast.1").display()),
    }
    Ok(ExitCode::SUCCESS)
}
