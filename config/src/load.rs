//! A scenario with all that it names.

use std::{fs, path::Path};

use ferntast_control::{frame::WIRE_LENGTH, servo::ServoConfig};
use ferntast_emulation::{
    channel::{ChannelConfig, LONGEST_DELAY, LinkConfig},
    hand::{Hand, RecordedHand, RecordedMotion, ScriptedHand},
};
use ferntast_model::{JointCount, ParameterError};
use serde::{Deserialize, Serialize};

use super::{
    ArmFile, Believed, ConfigError, HandSource, LeaderConfig, LoadArm, Scenario,
    file::{FileKind, load, load_with_path},
    serial,
};

/// A scenario with all that it names.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Loaded {
    /// Where the scenario came from.
    pub path: String,
    /// The scenario.
    pub scenario: Scenario,
    /// The arm.
    pub arm: ArmFile,
    /// The channel of the link.
    pub link: LinkConfig,
    /// Text of the recorded hand motion.
    pub hand_recording: Option<String>,
    /// The arm that is the master, where one is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub leader: Option<ArmFile>,
}

/// A file of `config/links/`.
pub const LINK: FileKind = FileKind {
    name: "link",
    folder: "links",
};
/// A file of `config/scenarios/`.
pub const SCENARIO: FileKind = FileKind {
    name: "scenario",
    folder: "scenarios",
};

/// The links that come along, by name, the quickest first: those of these names on disk
/// where there are any. One that cannot be read is left out; who asks for it is told why.
pub fn known_links() -> Vec<(&'static str, LinkConfig)> {
    let links = LINK.shipped().into_iter();
    let links = links.filter_map(|name| Some((name, load(LINK, name, LinkConfig::validate).ok()?)));
    let mut links: Vec<(&str, LinkConfig)> = links.collect();
    links.sort_by(|(_, a), (_, b)| {
        let [a, b] = [a, b].map(|link| link.nominal_round_trip(WIRE_LENGTH));
        a.total_cmp(&b)
    });
    links
}

/// Loads the scenario `name`, shipped or a file, with the arm and the link that it names.
///
/// # Errors
///
/// What is wrong, in which file, and how to correct it.
pub fn load_scenario(name: &str, load_arm: LoadArm) -> Result<Loaded, ConfigError> {
    let (path, scenario) = load_with_path(SCENARIO, name, Scenario::validate)?;
    let mut loaded = Loaded {
        arm: load_arm(&scenario.arm)?,
        link: load(LINK, &scenario.link.channel, LinkConfig::validate)?,
        path,
        scenario,
        hand_recording: None,
        leader: None,
    };
    if let Some(leader) = &loaded.scenario.hand.leader {
        loaded.leader = Some(load_leader(&leader.arm, load_arm)?);
    }
    if let Believed::Serial(serial) = &loaded.arm.model {
        serial::fit(&mut loaded.scenario, serial, false)
            .map_err(|error| (loaded.path.as_str(), error))?;
    }
    Ok(loaded)
}

/// Loads the arm that is the master; one out of a URDF, of which more is known than where its tip is.
fn load_leader(name: &str, load_arm: LoadArm) -> Result<ArmFile, ConfigError> {
    let leader = load_arm(name)?;
    match leader.model.serial() {
        Some(_) => Ok(leader),
        None => Err(ConfigError::Leader {
            arm: name.to_owned(),
        }),
    }
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
    pub fn without_operator(arm: ArmFile, servo: ServoConfig, seed: u64) -> Loaded {
        Loaded {
            path: String::new(),
            scenario: Scenario::without_operator(servo, seed),
            arm,
            link: LinkConfig::default(),
            hand_recording: None,
            leader: None,
        }
    }

    /// Takes another arm: its servo's tuning, and a script that touches what is beside it.
    ///
    /// # Errors
    ///
    /// As for the scenario's own.
    pub fn set_arm(&mut self, name: &str, load_arm: LoadArm) -> Result<(), ConfigError> {
        self.arm = load_arm(name)?;
        name.clone_into(&mut self.scenario.arm);
        if let Believed::Serial(serial) = &self.arm.model {
            self.scenario.servo = ServoConfig::default();
            serial::fit(&mut self.scenario, serial, true).map_err(|error| (name, error))?;
            self.scenario.name.clone_from(&serial.name);
            self.scenario.description = format!("A hand drives {}.", serial.name);
        }
        Ok(())
    }

    /// Takes an arm as the master, moved and read through the driver that the scenario names for
    /// it, or else a simulated one.
    ///
    /// # Errors
    ///
    /// As for an arm; one that is not out of a URDF.
    pub fn set_leader(&mut self, name: &str, load_arm: LoadArm) -> Result<(), ConfigError> {
        self.leader = Some(load_leader(name, load_arm)?);
        let leader = &mut self.scenario.hand.leader;
        *leader = Some(LeaderConfig {
            arm: name.to_owned(),
            ..leader.take().unwrap_or_default()
        });
        Ok(())
    }

    /// Takes another channel.
    ///
    /// # Errors
    ///
    /// As for the scenario's own.
    pub fn set_link(&mut self, name: &str) -> Result<(), ConfigError> {
        self.link = load(LINK, name, LinkConfig::validate)?;
        name.clone_into(&mut self.scenario.link.channel);
        Ok(())
    }

    /// Replaces the channel by one of constant delay, half of `round_trip_ms` \[ms\] each way.
    ///
    /// # Errors
    ///
    /// A round trip out of its bounds.
    pub fn set_round_trip(&mut self, round_trip_ms: f64) -> Result<(), ConfigError> {
        let longest_ms = 2.0 * LONGEST_DELAY * 1e3;
        if !(0.0..=longest_ms).contains(&round_trip_ms) {
            return Err(ConfigError::RoundTrip {
                round_trip_ms,
                longest_ms,
            });
        }
        let each_way = ChannelConfig::with_delay(round_trip_ms * 1e-3 / 2.0);
        self.link = LinkConfig {
            description: format!("Constant, {round_trip_ms} ms round trip."),
            up: each_way.clone(),
            down: each_way,
        };
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
            .and_then(|()| self.check_servo())
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
            HandSource::Leader if self.leader.is_none() => {
                Err(missing("leader", "leader (or --arm-leader)"))
            }
            _ => Ok(()),
        }
    }

    /// The servo's lists have one entry for each joint of the arm.
    fn check_servo(&self) -> Result<(), ParameterError> {
        let joints = JointCount::new(self.arm.model.joints().len())?;
        let tuning = self.scenario.servo.joints(joints);
        tuning.map(drop).map_err(|error| error.within("servo"))
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
            HandSource::Crtk | HandSource::Haply | HandSource::Leader => Ok(None),
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

#[cfg(test)]
mod tests {
    use super::super::load_model_only;
    use super::*;

    #[test]
    fn a_servo_tuned_for_other_joints_is_refused_before_the_session() {
        let mut loaded = load_scenario("rokviss", load_model_only).unwrap();
        loaded.scenario.servo.damping = vec![100.0; 3];
        let words = loaded.complete().unwrap_err().to_string();
        let expected = "servo.damping has 3 entries where 2 are needed: one for each joint";
        assert!(words.contains(expected), "{words}");
    }

    #[test]
    fn a_round_trip_is_told_as_it_was_asked_for() {
        let mut loaded = load_scenario("rokviss", load_model_only).unwrap();
        for wrong in [-5.0, 10_001.0, f64::NAN] {
            let words = loaded.set_round_trip(wrong).unwrap_err().to_string();
            let expected = format!("{wrong} ms (--rtt) is outside 0 … 10000 ms");
            assert!(words.contains(&expected), "{words}");
        }
        loaded.set_round_trip(600.0).unwrap();
        assert!((loaded.link.up.delay + loaded.link.down.delay - 0.6).abs() < 1e-12);
    }
}
