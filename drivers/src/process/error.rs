//! What a plant in a program of its own does wrong.

use std::{io, process::ExitStatus};

/// Why a plant in a program of its own cannot be used, or no longer.
#[derive(Debug, thiserror::Error)]
pub enum PlantError {
    /// The program cannot be started.
    #[error("the plant cannot be started: {0}; give a command, such as process:python3 plant.py")]
    Start(io::Error),
    /// There is no command.
    #[error("no program is named; give its command, such as process:python3 plant.py")]
    NoCommand,
    /// It does not answer.
    #[error(
        "the plant has been silent for {seconds} s, {at}; it has to answer each record and to flush"
    )]
    Silent {
        /// How long it was waited for \[s\].
        seconds: f64,
        /// When in its time.
        at: At,
    },
    /// It has ended.
    #[error("the plant has ended {at}, {how}; what it said stands above")]
    Ended {
        /// When in its time.
        at: At,
        /// With which status, where that is known.
        how: Ending,
    },
    /// The pipe does not work.
    #[error("the pipe to the plant broke {at}: {source}")]
    Pipe {
        /// When in its time.
        at: At,
        /// The operating system's reason.
        source: io::Error,
    },
    /// Its answer to the greeting is none.
    #[error("the plant answered the greeting with {line:?}: {reason}; see docs/process_driver.md")]
    Greeting {
        /// What it said.
        line: String,
        /// What is wrong with it.
        reason: String,
    },
    /// It has other joints.
    #[error("the plant has the joints {found} where {wanted} are needed; name them alike")]
    Joints {
        /// Its joints.
        found: String,
        /// Those of the arm.
        wanted: String,
    },
    /// It measures something that is not known.
    #[error("the plant gives {name:?}, which is not known; known are {known}")]
    Unknown {
        /// What it gives.
        name: String,
        /// What it may give.
        known: String,
    },
    /// It steps by another time.
    #[error("the plant steps by {found} s where {wanted} s are needed")]
    Period {
        /// Its step \[s\].
        found: f64,
        /// That of the session \[s\].
        wanted: f64,
    },
    /// A number that is none.
    #[error("the plant gives {value} for {what} {number}, {at}; it has to give numbers")]
    NotFinite {
        /// Of what.
        what: &'static str,
        /// Which of them, from 1.
        number: usize,
        /// What it gave.
        value: f64,
        /// When in its time.
        at: At,
    },
}

/// When something happened, in the time of the plant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum At {
    /// At the greeting.
    Greeting,
    /// After so much of its time \[s\].
    Time(f64),
}

impl std::fmt::Display for At {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            At::Greeting => write!(formatter, "at the greeting"),
            At::Time(seconds) => write!(formatter, "at {seconds:.3} s of its time"),
        }
    }
}

/// How a program ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ending(pub Option<ExitStatus>);

impl std::fmt::Display for Ending {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.0 {
            Some(status) => write!(formatter, "with {status}"),
            None => write!(formatter, "or has closed its output"),
        }
    }
}
