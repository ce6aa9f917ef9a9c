//! Why configuration cannot be used.

use std::{io, path::PathBuf};

use ferntast_emulation::hand::RecordingError;
use ferntast_model::ParameterError;

use super::serial::SerialError;

/// Why configuration cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    /// Neither a file nor a shipped name.
    #[error(
        "{kind} {name:?}: no such file, and none of that name is shipped; shipped are: {shipped}"
    )]
    Unknown {
        /// Scenario, arm or link.
        kind: &'static str,
        /// What was asked for.
        name: String,
        /// What is there.
        shipped: String,
    },
    /// A file cannot be read.
    #[error("cannot read {path}: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// The operating system's reason.
        source: io::Error,
    },
    /// A file is not what it should be: unknown key, wrong type, bad syntax.
    #[error("{path}: {message}")]
    Syntax {
        /// The file.
        path: String,
        /// Line, key, and what is wrong.
        message: String,
    },
    /// A value is out of its bounds.
    #[error("{path}: {source}")]
    Value {
        /// The file.
        path: String,
        /// Key, value, bounds, unit.
        source: ParameterError,
    },
    /// A round trip that no channel has.
    #[error("a round trip of {round_trip_ms} ms (--rtt) is outside 0 … {longest_ms} ms")]
    RoundTrip {
        /// As asked for \[ms\].
        round_trip_ms: f64,
        /// The longest one \[ms\].
        longest_ms: f64,
    },
    /// An arm's configuration is not one that the arm's driver reads.
    #[error("the arm's configuration is not one of its driver: {0}")]
    Arm(serde_json::Error),
    /// An arm out of a URDF cannot be used.
    #[error("{path}: {source}")]
    Serial {
        /// The file.
        path: String,
        /// What is wrong, and how to correct it.
        source: Box<SerialError>,
    },
    /// An arm that comes along without its URDF.
    #[error(
        "cannot read {path}: this arm comes without its URDF, for its licence; get it from where its file says \
         (`ferntast config show arms/{arm}.toml`) and put it there, or give a TOML file beside it by its path"
    )]
    NoUrdf {
        /// The arm.
        arm: String,
        /// Where it is looked for.
        path: PathBuf,
    },
    /// A recorded hand motion cannot be used.
    #[error("{path}: {source}")]
    Hand {
        /// The file.
        path: PathBuf,
        /// Line, and what is wrong.
        source: RecordingError,
    },
    /// The hand is to be scripted or recorded, and the script or file is missing.
    #[error("{path}: hand.source is {source_name:?}, but hand.{missing} is missing")]
    NoHand {
        /// The scenario.
        path: String,
        /// The source.
        source_name: &'static str,
        /// The missing key.
        missing: &'static str,
    },
    /// An arm that cannot be the master.
    #[error(
        "arm {arm:?} cannot be the leader: it is one of two links in a plane; give an arm out of a URDF \
         (--arm-leader so101, or a file)"
    )]
    Leader {
        /// Its name.
        arm: String,
    },
}

impl From<(&str, SerialError)> for ConfigError {
    /// What is wrong in the file of that path.
    fn from((path, source): (&str, SerialError)) -> ConfigError {
        ConfigError::Serial {
            path: path.to_owned(),
            source: Box::new(source),
        }
    }
}
