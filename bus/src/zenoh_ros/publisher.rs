//! Sending over Zenoh.

use ferntast_msgs::{Message, RosMessage, Time, topics::Topic};
use hiroz::{Builder, msg::SerdeCdrSerdes, pubsub::ZPub};

use super::{
    ZenohBus, middleware,
    qos::{places, qos},
    raw::{Raw, type_info},
};
use crate::{
    error::{CreateError, PublishError},
    namespace::within,
    zenoh_words::words,
};

/// Sends on one topic over Zenoh.
#[derive(Debug)]
pub struct ZenohPublisher<M: Message> {
    topic: Topic<M>,
    port: ZPub<Raw, SerdeCdrSerdes<Raw>>,
    bytes: Vec<u8>,
    // Kept: the session.
    _bus: ZenohBus,
}

impl<M: Message> ZenohPublisher<M> {
    pub(super) fn create(
        bus: &ZenohBus,
        topic: Topic<M>,
    ) -> Result<ZenohPublisher<M>, CreateError> {
        let failed = |reason: String| middleware(&topic.name, "publisher", reason);
        let type_info = type_info::<M>().map_err(failed)?;
        let port = bus
            .node
            .create_pub_impl::<Raw>(&within(bus.namespace(), &topic.name), Some(type_info))
            .with_qos(qos(topic.delivery, places(topic.delivery)))
            .build()
            .map_err(|error| failed(words(error)))?;
        Ok(ZenohPublisher {
            topic,
            port,
            bytes: Vec::new(),
            _bus: bus.clone(),
        })
    }

    /// Publishes in ROS 2 form. Allocates, and waits on reliable topics while
    /// the network is congested: not for the control path.
    ///
    /// # Errors
    ///
    /// [`PublishError::Encode`], [`PublishError::Middleware`].
    pub fn publish(&mut self, _now: Time, message: &M) -> Result<(), PublishError> {
        let encoded = message.to_ros().encode(&mut self.bytes);
        encoded.map_err(|source| PublishError::Encode {
            topic: self.topic.name,
            source,
        })?;
        self.port
            .publish_serialized(self.bytes.as_slice())
            .map_err(|error| PublishError::Middleware {
                transport: "Zenoh",
                topic: self.topic.name,
                reason: words(error),
            })
    }
}
