//! Sending bytes over DDS.

use ros2_client::{
    MessageTypeName, Name, Publisher,
    dds::rustdds::{QosPolicies, TopicDescription, TopicKind, policy::ResourceLimits},
    qos::{Durability, History, QosProfile},
};
use serde::{Serialize, Serializer, ser::SerializeTuple};

use super::{DdsBus, qos::WAIT};
use crate::{
    error::{CreateError, RawPublishError},
    namespace::within,
    raw_topic::RawTopic,
};

/// The body of a message. To the CDR serializer of ros2-client it is a tuple of octets, which
/// CDR writes as they are, one after the other.
struct Body(Vec<u8>);

impl Serialize for Body {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut tuple = serializer.serialize_tuple(self.0.len())?;
        for byte in &self.0 {
            tuple.serialize_element(byte)?;
        }
        tuple.end()
    }
}

/// Sends bytes on one topic over DDS.
pub struct RawDdsPublisher {
    writer: Publisher<Body>,
    // Kept: a writer without its participant is dead.
    _bus: DdsBus,
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
        // The same once more, with the limits that the node's has not.
        let (name, kind) = (ros_topic.name(), ros_topic.get_type());
        let limited = self
            .participant
            .create_topic(
                name,
                kind.name().to_owned(),
                &offered(topic),
                TopicKind::NoKey,
            )
            .map_err(|error| failed(error.to_string()))?;
        let writer = node
            .create_publisher(&limited, None)
            .map_err(|error| failed(error.to_string()))?;
        Ok(RawDdsPublisher {
            writer,
            _bus: self.clone(),
        })
    }
}

impl RawDdsPublisher {
    /// Publishes the body of a message, without its header.
    pub(crate) fn publish(&mut self, body: &[u8]) -> Result<(), RawPublishError> {
        let sent = self.writer.publish(Body(body.to_vec()));
        sent.map_err(|error| RawPublishError::Middleware {
            transport: "DDS",
            reason: error.to_string(),
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

/// What is kept for late joiners has the limits that [`super::qos`] tells of.
fn offered(topic: &RawTopic) -> QosPolicies {
    let policies = QosPolicies::from(&profile(topic));
    if !topic.transient_local {
        return policies;
    }
    let most = i32::try_from(topic.depth.max(64)).unwrap_or(i32::MAX);
    let limits = ResourceLimits {
        max_samples: most,
        max_instances: 1,
        max_samples_per_instance: most,
    };
    policies.modify_by(&QosPolicies::builder().resource_limits(limits).build())
}
