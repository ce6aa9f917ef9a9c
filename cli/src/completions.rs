//! `ferntast completions`.

use std::{
    io::{self, Write},
    process::ExitCode,
};

use clap::Command;
use clap_complete::{Shell, generate};

use super::Failure;

/// Print what completes this command's words in a shell.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "bash:  ferntast completions bash > ~/.local/share/bash-completion/completions/ferntast\n\
    zsh:   ferntast completions zsh > \"${fpath[1]}/_ferntast\"\n\
    fish:  ferntast completions fish > ~/.config/fish/completions/ferntast.fish"
)]
pub struct Arguments {
    /// The shell.
    shell: Shell,
}

/// Runs it; `command` is the whole command line.
pub fn run(arguments: &Arguments, mut command: Command) -> Result<ExitCode, Failure> {
    let mut text = Vec::new();
    generate(arguments.shell, &mut command, "ferntast", &mut text);
    io::stdout().write_all(&text).map_err(Failure::failed)?;
    Ok(ExitCode::SUCCESS)
}
