//! Finds, reads and checks configuration.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use ferntast_control::servo::ServoConfig;
use ferntast_model::ParameterError;
use ferntast_sim::{
    arm::ArmConfig,
    channel::{ChannelConfig, LinkConfig},
    hand::{Hand, RecordedHand, RecordedMotion, RecordingError, ScriptedHand},
};
use serde::{Deserialize, Serialize, de::DeserializeOwned};

use super::{HandSource, Scenario, shipped};
use crate::experiment::campaign::Mission;
use crate::sweep::SweepConfig;

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
}

/// A scenario with all that it names.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Loaded {
    /// Where the scenario came from.
    pub path: String,
    /// The scenario.
    pub scenario: Scenario,
    /// The arm.
    pub arm: ArmConfig,
    /// The channel of the link.
    pub link: LinkConfig,
    /// Text of the recorded hand motion.
    pub hand_recording: Option<String>,
}

struct Source {
    path: String,
    text: String,
}

fn find(kind: &'static str, folder: &'static str, name: &str) -> Result<Source, ConfigError> {
    let path = Path::new(name);
    let below = format!("{folder}/{name}.toml");
    let on_disk = Path::new("config").join(&below);
    let looks_like_path = name.contains('/') || name.ends_with(".toml");
    let read = |path: &Path| {
        fs::read_to_string(path)
            .map(|text| Source {
                path: path.display().to_string(),
                text,
            })
            .map_err(|source| ConfigError::Read {
                path: path.to_owned(),
                source,
            })
    };
    if looks_like_path {
        return read(path);
    }
    if on_disk.is_file() {
        return read(&on_disk);
    }
    match shipped::text(&below) {
        Some(text) => Ok(Source {
            path: format!("{below} (shipped)"),
            text: text.to_owned(),
        }),
        None => Err(ConfigError::Unknown {
            kind,
            name: name.to_owned(),
            shipped: shipped::names(folder).join(", "),
        }),
    }
}

fn parse<T: DeserializeOwned>(source: &Source) -> Result<T, ConfigError> {
    toml::from_str(&source.text).map_err(|error| ConfigError::Syntax {
        path: source.path.clone(),
        message: error.to_string().trim_end().to_owned(),
    })
}

fn checked<T>(
    source: &Source,
    value: T,
    result: Result<(), ParameterError>,
) -> Result<T, ConfigError> {
    match result {
        Ok(()) => Ok(value),
        Err(error) => Err(ConfigError::Value {
            path: source.path.clone(),
            source: error,
        }),
    }
}

fn load_link(name: &str) -> Result<LinkConfig, ConfigError> {
    let source = find("link", "links", name)?;
    let link: LinkConfig = parse(&source)?;
    let valid = link.validate();
    checked(&source, link, valid)
}

/// Loads the arm `name`, shipped or a file.
///
/// # Errors
///
/// What is wrong, in which file, and how to mend it.
pub fn load_arm(name: &str) -> Result<ArmConfig, ConfigError> {
    let source = find("arm", "arms", name)?;
    let arm: ArmConfig = parse(&source)?;
    let valid = arm.validate();
    checked(&source, arm, valid)
}

/// Loads the campaign `name`, shipped or a file.
///
/// # Errors
///
/// What is wrong, in which file, and how to mend it.
pub fn load_mission(name: &str) -> Result<Mission, ConfigError> {
    let source = find("campaign", "experiments", name)?;
    let mission: Mission = parse(&source)?;
    let valid = mission.validate();
    checked(&source, mission, valid)
}

/// Loads the scenario `name`, shipped or a file, with the arm and the link that it names.
///
/// # Errors
///
/// What is wrong, in which file, and how to mend it.
pub fn load_scenario(name: &str) -> Result<Loaded, ConfigError> {
    let source = find("scenario", "scenarios", name)?;
    let scenario: Scenario = parse(&source)?;
    let valid = scenario.validate();
    let scenario = checked(&source, scenario, valid)?;
    let arm = load_arm(&scenario.arm)?;
    let link = load_link(&scenario.link.channel)?;
    Ok(Loaded {
        path: source.path,
        scenario,
        arm,
        link,
        hand_recording: None,
    })
}

/// Loads the sweep `name`, shipped or a file.
///
/// # Errors
///
/// What is wrong, in which file, and how to mend it.
pub fn load_sweep(name: &str) -> Result<SweepConfig, ConfigError> {
    let source = find("sweep", "scenarios", name)?;
    let sweep: SweepConfig = parse(&source)?;
    let valid = sweep.validate();
    checked(&source, sweep, valid)
}

/// Reads and checks a file with recorded hand motion; gives its text.
///
/// # Errors
///
/// A file that cannot be read, a line that is no sample.
pub fn read_hand_recording(path: &Path) -> Result<String, ConfigError> {
    let text = fs::read_to_string(path).map_err(|source| ConfigError::Read {
        path: path.to_owned(),
        source,
    })?;
    match RecordedMotion::parse(&text) {
        Ok(_) => Ok(text),
        Err(source) => Err(ConfigError::Hand {
            path: path.to_owned(),
            source,
        }),
    }
}

impl Loaded {
    /// An arm and its servo with nobody who operates them, for experiments.
    pub fn without_operator(arm: ArmConfig, servo: ServoConfig, seed: u64) -> Loaded {
        Loaded {
            path: String::new(),
            scenario: Scenario::without_operator(servo, seed),
            arm,
            link: LinkConfig::default(),
            hand_recording: None,
        }
    }

    /// Takes another channel.
    ///
    /// # Errors
    ///
    /// As for the scenario's own.
    pub fn set_link(&mut self, name: &str) -> Result<(), ConfigError> {
        self.link = load_link(name)?;
        name.clone_into(&mut self.scenario.link.channel);
        Ok(())
    }

    /// Replaces the channel by one of constant delay, half of `round_trip` \[s\] each way.
    ///
    /// # Errors
    ///
    /// A round trip out of its bounds.
    pub fn set_round_trip(&mut self, round_trip: f64) -> Result<(), ConfigError> {
        let link = LinkConfig {
            description: format!("Constant, {} ms round trip.", round_trip * 1e3),
            up: ChannelConfig::with_delay(round_trip / 2.0),
            down: ChannelConfig::with_delay(round_trip / 2.0),
        };
        link.validate().map_err(|source| ConfigError::Value {
            path: "--rtt".to_owned(),
            source,
        })?;
        self.link = link;
        Ok(())
    }

    /// Reads what the scenario's hand needs, and checks that nothing is missing.
    ///
    /// # Errors
    ///
    /// A missing or broken recording of the hand, a missing script, a value out of bounds.
    pub fn complete(&mut self) -> Result<(), ConfigError> {
        self.scenario
            .validate()
            .map_err(|source| ConfigError::Value {
                path: self.path.clone(),
                source,
            })?;
        let missing = |source_name, missing| ConfigError::NoHand {
            path: self.path.clone(),
            source_name,
            missing,
        };
        match self.scenario.hand.source {
            HandSource::Scripted if self.scenario.hand.scripted.is_none() => {
                Err(missing("scripted", "scripted"))
            }
            HandSource::Recorded if self.hand_recording.is_none() => {
                let Some(path) = &self.scenario.hand.recording else {
                    return Err(missing("recorded", "recording"));
                };
                self.hand_recording = Some(read_hand_recording(path)?);
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// The hand that the master has of its own; none where CRTK clients are the hand.
    ///
    /// # Errors
    ///
    /// As [`Loaded::complete`].
    pub fn hand(&self) -> Result<Option<Hand>, ConfigError> {
        let section = &self.scenario.hand;
        let bad_value = |source| ConfigError::Value {
            path: self.path.clone(),
            source,
        };
        match section.source {
            HandSource::Crtk => Ok(None),
            HandSource::Scripted => {
                let scripted = section.scripted.clone().unwrap_or_default();
                let hand = ScriptedHand::new(&scripted, self.scenario.seed).map_err(bad_value)?;
                Ok(Some(Hand::Scripted(Box::new(hand))))
            }
            HandSource::Recorded => {
                let text = self.hand_recording.as_deref().unwrap_or_default();
                let motion = RecordedMotion::parse(text).map_err(|source| ConfigError::Hand {
                    path: section.recording.clone().unwrap_or_default(),
                    source,
                })?;
                let hand = RecordedHand::new(motion, section.recorded).map_err(bad_value)?;
                Ok(Some(Hand::Recorded(hand)))
            }
        }
    }
}
