//! The recording that is fed again.

use std::path::Path;

use ferntast_bag::{BagInfo, BagReader};
use ferntast_bus::{Bus, CreateError, McapBus};
use ferntast_config::Loaded;
use ferntast_lab::experiment::RECORD;
use ferntast_msgs::{
    Time,
    sample::JointNames,
    topics::{EVENT_QUEUE, TopicName},
};

use super::ReplayError;
use crate::{
    bridge::forwarder::{Forwarder, Forwarding, Stamp},
    graph::NodeRow,
};

/// A recording of lockstep.
pub struct Recorded {
    /// Its topics.
    pub bus: Bus,
    info: BagInfo,
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
        let info = ferntast_bag::info(path).map_err(|error| open(&error))?;
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
        Loaded::of_entries(&entry).map_err(|error| ReplayError::Origin(error.to_string()))
    }

    fn has(&self, topic: &str) -> bool {
        self.topics.iter().any(|own| own == topic)
    }

    fn has_messages(&self, topic: &str) -> bool {
        let counted = self.info.topics.iter().find(|own| own.name == topic);
        counted.is_some_and(|own| own.messages > 0)
    }

    /// Forwards what the nodes of `rows` take of an arm of those joints and none
    /// of them publishes.
    ///
    /// # Errors
    ///
    /// A topic that cannot be opened.
    pub fn inputs(
        &self,
        rows: &[&NodeRow],
        joints: &JointNames,
        to: &Bus,
    ) -> Result<Forwarder, CreateError> {
        let (mut taken, mut published) = (Vec::new(), Vec::new());
        for row in rows {
            taken.extend(row.inputs(joints)?);
            published.extend(row.outputs(joints)?);
        }
        let mut forwarder = Forwarder::default();
        forwarder.add_topics(&self.bus, to, Stamp::Received, joints, |topic| {
            let name = topic.name;
            match taken.contains(&name) && !published.contains(&name) && self.has(&name) {
                true => Forwarding::Every { queue: EVENT_QUEUE },
                false => Forwarding::Not,
            }
        })?;
        Ok(forwarder)
    }

    /// Topics of which what the nodes of `rows` publish is compared. Recordings
    /// of earlier versions lack some; one without a twin has the twin's without
    /// messages.
    ///
    /// # Errors
    ///
    /// A joint's name that cannot be part of a topic's.
    pub fn outputs(
        &self,
        rows: &[&NodeRow],
        joints: &JointNames,
    ) -> Result<Vec<TopicName>, CreateError> {
        let mut compared = Vec::new();
        for row in rows {
            let outputs = row.outputs(joints)?;
            if outputs.iter().any(|topic| self.has_messages(topic)) {
                compared.extend(outputs.into_iter().filter(|topic| self.has(topic)));
            }
        }
        Ok(compared)
    }
}
