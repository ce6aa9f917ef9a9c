//! Sending bytes over DDS.

use ros2_client::{
    MessageTypeName, Name,
    qos::{Durability, History, QosProfile},
};

use super::{DdsBus, qos::WAIT, writer::Writer};
use crate::{
    error::{CreateError, RawPublishError},
    namespace::within,
    raw_topic::RawTopic,
};

/// Sends bytes on one topic over DDS.
pub struct RawDdsPublisher {
    writer: Writer,
}

impl DdsBus {
    /// A publisher of bytes on `topic`.
    ///
    /// # Errors
    ///
    /// [`CreateError::Middleware`].
    pub fn raw_publisher(&self, topic: &RawTopic) -> Result<RawDdsPublisher, CreateError> {
        let failed = |reason: String| topic.refused("DDS", reason);
        let (package, kind) = topic.kind("DDS")?;
        let mut node = self.node();
        let name = Name::parse(&within(node.namespace(), &topic.name))
            .map_err(|error| failed(format!("{error:?}")))?;
        let ros_topic = node
            .create_topic(&name, MessageTypeName::new(package, kind), &profile(topic))
            .map_err(|error| failed(error.to_string()))?;
        let kept = topic.transient_local.then_some(topic.depth);
        let writer = Writer::new(self, &mut node, &ros_topic, kept).map_err(failed)?;
        Ok(RawDdsPublisher { writer })
    }
}

impl RawDdsPublisher {
    /// Publishes a message with its header.
    pub(crate) fn publish(&mut self, bytes: &[u8]) -> Result<(), RawPublishError> {
        let sent = self.writer.write(bytes.to_vec());
        sent.map_err(|reason| RawPublishError::Middleware {
            transport: "DDS",
            reason,
        })
    }
}

fn profile(topic: &RawTopic) -> QosProfile {
    let base = QosProfile::subscription_default();
    let base = match topic.reliable {
        true => base.reliability_reliable(WAIT),
        false => base.reliability_best_effort(),
    };
    let durability = match topic.transient_local {
        true => Durability::TransientLocal,
        false => Durability::Volatile,
    };
    base.durability(durability)
        .history(History::KeepLast { depth: topic.depth })
}
