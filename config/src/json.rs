//! A scenario with all that it names as JSON: in a session's file, and in what a recording tells of itself.

use ferntast_emulation::channel::LinkConfig;
use serde::{Deserialize, Deserializer, Serialize, Serializer, de, ser};
use serde_json::value::{RawValue, to_raw_value};

use super::Loaded;

/// Keys of a recording's entries.
const SCENARIO: &str = "scenario";
const ARM: &str = "arm";
const LINK: &str = "link";

impl Loaded {
    /// What a recording tells of it, by key: scenario, arm and link, each as JSON.
    pub fn entries(&self) -> [(&'static str, String); 3] {
        let json = |value: Result<String, serde_json::Error>| value.unwrap_or_default();
        [
            (SCENARIO, json(serde_json::to_string(&self.scenario))),
            (ARM, json(serde_json::to_string(&self.arm))),
            (LINK, json(serde_json::to_string(&self.link))),
        ]
    }

    /// Of a recording's entries, each asked for by its key: scenario and arm. The link and the hand
    /// have no part in what is run again.
    ///
    /// # Errors
    ///
    /// An entry that is not as [`entries`](Self::entries) has it.
    pub fn of_entries<'a>(entry: &dyn Fn(&str) -> &'a str) -> Result<Loaded, serde_json::Error> {
        Ok(Loaded {
            path: String::new(),
            scenario: serde_json::from_str(entry(SCENARIO))?,
            arm: serde_json::from_str(entry(ARM))?,
            link: LinkConfig::default(),
            hand_recording: None,
            leader: None,
        })
    }

    fn to_json(&self) -> Result<Box<RawValue>, serde_json::Error> {
        to_raw_value(self)
    }

    fn of_json(text: &RawValue) -> Result<Loaded, serde_json::Error> {
        serde_json::from_str(text.get())
    }
}

/// For a field within JSON, `#[serde(with = "ferntast_config::json")]`: what is compiled where the
/// field is knows nothing of what is in a scenario.
///
/// # Errors
///
/// A number that JSON cannot hold; another form than JSON.
pub fn serialize<S: Serializer>(loaded: &Loaded, serializer: S) -> Result<S::Ok, S::Error> {
    let text = loaded.to_json().map_err(ser::Error::custom)?;
    text.serialize(serializer)
}

/// The other way round.
///
/// # Errors
///
/// Something else than [`serialize`] wrote.
pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Loaded, D::Error> {
    let text = Box::<RawValue>::deserialize(deserializer)?;
    Loaded::of_json(&text).map_err(de::Error::custom)
}
