//! What a command leaves behind: JSON, messages, exit codes.

use std::{
    fmt,
    io::{IsTerminal, Write},
    process::ExitCode,
};

use serde::Serialize;

use ferntast_nodes::session::SessionError;

/// Why a command failed: a message, and whose turn it is.
#[derive(Debug)]
pub struct Failure {
    message: String,
    code: u8,
}

impl Failure {
    /// The input was refused: nothing was done (exit code 2).
    pub fn refused(error: impl fmt::Display) -> Failure {
        Failure {
            message: error.to_string(),
            code: 2,
        }
    }

    /// Something failed on the way (exit code 1).
    pub fn failed(error: impl fmt::Display) -> Failure {
        Failure {
            message: error.to_string(),
            code: 1,
        }
    }

    /// What kept a session from running: refused before anything moved, or
    /// failed on the way.
    pub fn of_session(error: SessionError) -> Failure {
        match error.is_refusal() {
            true => Failure::refused(error),
            false => Failure::failed(error),
        }
    }

    /// Says so on stderr.
    pub fn report(&self) -> ExitCode {
        let paint = std::io::stderr().is_terminal();
        let (red, plain) = if paint {
            ("\x1b[1;31m", "\x1b[0m")
        } else {
            ("", "")
        };
        eprintln!("{red}error:{plain} {}", self.message);
        ExitCode::from(self.code)
    }
}

/// Prints `value` as one JSON value on stdout.
///
/// # Errors
///
/// stdout is closed, or the value has no JSON form.
pub fn print_json(value: &impl Serialize) -> Result<(), Failure> {
    let mut stdout = std::io::stdout().lock();
    serde_json::to_writer_pretty(&mut stdout, value).map_err(Failure::failed)?;
    writeln!(stdout).map_err(Failure::failed)
}

/// Prints `value` as one line of JSON on stdout: one of many.
///
/// # Errors
///
/// As [`print_json`].
pub fn print_json_line(value: &impl Serialize) -> Result<(), Failure> {
    let mut stdout = std::io::stdout().lock();
    serde_json::to_writer(&mut stdout, value).map_err(Failure::failed)?;
    writeln!(stdout).map_err(Failure::failed)
}
