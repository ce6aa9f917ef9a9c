//! A schedule: what goes wrong, and when. A file of it is what is run again.

use std::{fmt, fs, path::Path};

use serde::{Deserialize, Serialize};

use super::fault::Fault;

/// How long a schedule runs where nothing else is said \[ms\].
pub const LENGTH_MS: i64 = 2500;

/// What goes wrong, and when; all else comes from the seed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Schedule {
    /// The scenario, shipped or a file.
    pub scenario: String,
    /// Seed of everything that is random in it.
    pub seed: u64,
    /// The delay law that it starts with.
    pub law: String,
    /// Length \[ms of virtual time\].
    pub length_ms: i64,
    /// A safety rule that is taken out; builds for tests only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub planted: Option<String>,
    /// What goes wrong, in order of time.
    #[serde(default)]
    pub event: Vec<Event>,
}

/// A fault at its time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// When it begins \[ms after the start\].
    pub at_ms: i64,
    /// What it is.
    #[serde(flatten)]
    pub fault: Fault,
}

/// Why a file is no schedule.
#[derive(Debug, thiserror::Error)]
pub enum ScheduleError {
    /// It cannot be read or written.
    #[error("{path}: {source}")]
    File {
        /// The file.
        path: String,
        /// The operating system's reason.
        source: std::io::Error,
    },
    /// It does not say what it should.
    #[error("{path} is no schedule of faults: {reason}; `ferntast faults` writes them")]
    Content {
        /// The file.
        path: String,
        /// What is wrong.
        reason: String,
    },
}

impl Schedule {
    /// Reads a file.
    ///
    /// # Errors
    ///
    /// A file that cannot be read or is no schedule.
    pub fn read(path: &Path) -> Result<Schedule, ScheduleError> {
        let name = path.display().to_string();
        let text = fs::read_to_string(path).map_err(|source| ScheduleError::File {
            path: name.clone(),
            source,
        })?;
        let content = |reason: String| ScheduleError::Content {
            path: name.clone(),
            reason,
        };
        let mut schedule: Schedule =
            toml::from_str(&text).map_err(|error| content(error.to_string()))?;
        if !(1..=600_000).contains(&schedule.length_ms) {
            return Err(content(format!(
                "length_ms is {}, not 1 … 600000",
                schedule.length_ms
            )));
        }
        schedule.event.sort_by_key(|event| event.at_ms);
        Ok(schedule)
    }

    /// As a file has it.
    ///
    /// # Errors
    ///
    /// A number that TOML cannot hold.
    pub fn text(&self) -> Result<String, toml::ser::Error> {
        toml::to_string(self)
    }

    /// Writes a file.
    ///
    /// # Errors
    ///
    /// It cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), ScheduleError> {
        let name = path.display().to_string();
        let text = self.text().map_err(|error| ScheduleError::Content {
            path: name.clone(),
            reason: error.to_string(),
        })?;
        fs::write(path, text).map_err(|source| ScheduleError::File { path: name, source })
    }
}

impl fmt::Display for Schedule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} ms of {} under {}",
            self.length_ms, self.scenario, self.law
        )?;
        for Event { at_ms, fault } in &self.event {
            write!(f, "\n  {at_ms:>5} ms  {fault}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::fault::{Device, Node, Way, Word};
    use super::*;

    #[test]
    fn a_file_gives_the_same_schedule() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("schedule.toml");
        let event = |at_ms, fault| Event { at_ms, fault };
        let schedule = Schedule {
            scenario: "rokviss".to_owned(),
            seed: 7,
            law: "wave".to_owned(),
            length_ms: 900,
            planted: None,
            event: vec![
                event(
                    0,
                    Fault::Crash {
                        node: Node::LinkLeader,
                    },
                ),
                event(
                    3,
                    Fault::Blackout {
                        way: Way::Back,
                        ms: 80,
                    },
                ),
                event(
                    9,
                    Fault::Word {
                        device: Device::Both,
                        word: Word::Resume,
                    },
                ),
            ],
        };
        schedule.write(&path).unwrap();
        assert_eq!(Schedule::read(&path).unwrap(), schedule);
        fs::write(&path, "seed = 1").unwrap();
        let words = Schedule::read(&path).unwrap_err().to_string();
        assert!(words.contains("no schedule of faults"), "{words}");
    }
}
