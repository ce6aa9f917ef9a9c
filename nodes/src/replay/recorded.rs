//! The recording that is fed again.

use std::path::Path;

use ferntast_bus::{
    Bus, CreateError, McapBus,
    mcap::{self, BagReader},
};
use ferntast_emulation::channel::LinkConfig;
use ferntast_lab::experiment::RECORD;
use ferntast_msgs::{Time, topics::EVENT_QUEUE};

use super::ReplayError;
use crate::{
    bridge::forwarder::{Forwarder, Forwarding, Stamp},
    config::Loaded,
    graph::NodeRow,
};

/// A recording of lockstep.
pub struct Recorded {
    /// Its topics.
    pub bus: Bus,
    info: mcap::BagInfo,
    /// Topics that it has, with messages or without.
    topics: Vec<String>,
    /// Time of its first message.
    pub start: Time,
    /// Time of its last message.
    pub end: Time,
}

impl Recorded {
    /// Opens the recording at `path`.
    ///
    /// # Errors
    ///
    /// It cannot be opened, or holds no message.
    pub fn open(path: &Path) -> Result<Recorded, ReplayError> {
        let open = |error: &dyn std::fmt::Display| ReplayError::Open(error.to_string());
        let info = mcap::info(path).map_err(|error| open(&error))?;
        let (Some(start), Some(end)) = (info.start, info.end) else {
            return Err(ReplayError::Open(format!(
                "{} holds no message",
                path.display()
            )));
        };
        let reader = BagReader::open(path).map_err(|error| open(&error))?;
        Ok(Recorded {
            bus: Bus::Mcap(McapBus::open(path).map_err(|error| open(&error))?),
            topics: reader.topics().map(|own| own.name.to_string()).collect(),
            info,
            start,
            end,
        })
    }

    /// What it was made of; the link and the hand have no part in a replay.
    ///
    /// # Errors
    ///
    /// It is none of lockstep.
    pub fn loaded(&self) -> Result<Loaded, ReplayError> {
        let origin = self.info.metadata.get(RECORD);
        let origin =
            origin.ok_or_else(|| ReplayError::Origin(format!("no metadata record {RECORD:?}")))?;
        let entry = |key: &str| origin.get(key).map(String::as_str).unwrap_or_default();
        if entry("mode") != "lockstep" {
            return Err(ReplayError::Origin(format!(
                "its mode is {:?}, in which steps are not at known times",
                entry("mode")
            )));
        }
        let bad = |error: serde_json::Error| ReplayError::Origin(error.to_string());
        Ok(Loaded {
            path: String::new(),
            scenario: serde_json::from_str(entry("scenario")).map_err(bad)?,
            arm: serde_json::from_str(entry("arm")).map_err(bad)?,
            link: LinkConfig::default(),
            hand_recording: None,
        })
    }

    fn has(&self, topic: &str) -> bool {
        self.topics.iter().any(|own| own == topic)
    }

    fn has_messages(&self, topic: &str) -> bool {
        let counted = self.info.topics.iter().find(|own| own.name == topic);
        counted.is_some_and(|own| own.messages > 0)
    }

    /// Forwards what the nodes of `rows` take and none of them publishes.
    ///
    /// # Errors
    ///
    /// A topic that cannot be opened.
    pub fn inputs(&self, rows: &[&NodeRow], to: &Bus) -> Result<Forwarder, CreateError> {
        let mut forwarder = Forwarder::default();
        forwarder.add_topics(&self.bus, to, Stamp::Received, |topic| {
            let name = topic.name;
            let taken = rows.iter().any(|row| row.inputs().contains(&name));
            let published = rows.iter().any(|row| row.outputs().contains(&name));
            match taken && !published && self.has(name) {
                true => Forwarding::Every { queue: EVENT_QUEUE },
                false => Forwarding::Not,
            }
        })?;
        Ok(forwarder)
    }

    /// Topics of which what the nodes of `rows` publish is compared. Recordings
    /// of earlier versions lack some; one without a twin has the twin's without
    /// messages.
    pub fn outputs(&self, rows: &[&NodeRow]) -> Vec<&'static str> {
        rows.iter()
            .filter(|row| row.outputs().iter().any(|topic| self.has_messages(topic)))
            .flat_map(|row| row.outputs())
            .copied()
            .filter(|topic| self.has(topic))
            .collect()
    }
}
