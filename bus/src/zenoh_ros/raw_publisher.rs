//! Sending bytes over Zenoh.

use std::num::NonZeroUsize;

use hiroz::{
    Builder,
    entity::{TypeHash, TypeInfo},
    msg::SerdeCdrSerdes,
    pubsub::ZPub,
    qos::{QosDurability, QosHistory, QosProfile, QosReliability},
};

use super::{ZenohBus, raw::Raw};
use crate::{
    error::{CreateError, RawPublishError},
    namespace::within,
    raw_topic::RawTopic,
    zenoh_words::words,
};

/// Sends bytes on one topic over Zenoh.
pub struct RawZenohPublisher {
    port: ZPub<Raw, SerdeCdrSerdes<Raw>>,
    // Kept: the session.
    _bus: ZenohBus,
}

impl ZenohBus {
    /// A publisher of bytes on `topic`.
    ///
    /// # Errors
    ///
    /// [`CreateError::Middleware`].
    pub fn raw_publisher(&self, topic: &RawTopic) -> Result<RawZenohPublisher, CreateError> {
        let failed = |reason: String| topic.refused("Zenoh", reason);
        let (package, kind) = topic.kind("Zenoh")?;
        let hash = TypeHash::from_rihs_string(&topic.type_hash).ok_or_else(|| {
            failed(
                "its type's hash is not known, by which Zenoh joins publishers and subscribers"
                    .to_owned(),
            )
        })?;
        let type_info = TypeInfo::new(&format!("{package}::msg::dds_::{kind}_"), hash);
        let port = self
            .node
            .create_pub_impl::<Raw>(&within(self.namespace(), &topic.name), Some(type_info))
            .with_qos(profile(topic))
            .build()
            .map_err(|error| failed(words(error)))?;
        Ok(RawZenohPublisher {
            port,
            _bus: self.clone(),
        })
    }
}

impl RawZenohPublisher {
    /// Publishes a message with its header.
    pub(crate) fn publish(&mut self, bytes: &[u8]) -> Result<(), RawPublishError> {
        let sent = self.port.publish_serialized(bytes);
        sent.map_err(|error| RawPublishError::Middleware {
            transport: "Zenoh",
            reason: words(error),
        })
    }
}

fn profile(topic: &RawTopic) -> QosProfile {
    let reliability = match topic.reliable {
        true => QosReliability::Reliable,
        false => QosReliability::BestEffort,
    };
    let durability = match topic.transient_local {
        true => QosDurability::TransientLocal,
        false => QosDurability::Volatile,
    };
    QosProfile {
        reliability,
        durability,
        history: QosHistory::KeepLast(NonZeroUsize::new(topic.depth).unwrap_or(NonZeroUsize::MIN)),
        ..QosProfile::default()
    }
}
