//! Sending over DDS.

use std::fmt;

use ferntast_msgs::{Message, Time, topics::Topic};
use ros2_client::{
    Publisher,
    dds::rustdds::{TopicDescription, TopicKind, dds::CreateError as CreateDdsError},
};

use super::{
    DdsBus, create_topic, middleware,
    qos::{offered, qos},
};
use crate::{
    cdr,
    error::{CreateError, PublishError},
};

/// Sends on one topic over DDS.
pub struct DdsPublisher<M: Message> {
    topic: Topic<M>,
    writer: Publisher<M::Ros>,
    // Kept: a writer without its participant is dead.
    _bus: DdsBus,
}

impl<M: Message> DdsPublisher<M> {
    pub(super) fn create(bus: &DdsBus, topic: Topic<M>) -> Result<DdsPublisher<M>, CreateError> {
        let mut node = bus.node();
        let failed =
            |error: CreateDdsError| middleware(&topic.name, "publisher", error.to_string());
        let ros_topic = create_topic(&node, topic, &qos(topic.delivery), "publisher")?;
        // The same once more, with the limits that the node's has not.
        let (name, kind) = (ros_topic.name(), ros_topic.get_type());
        let policies = offered(topic.delivery);
        let limited = bus
            .participant
            .create_topic(name, kind.name().to_owned(), &policies, TopicKind::NoKey)
            .map_err(failed)?;
        let writer = node
            .create_publisher(&limited, None)
            .map_err(|error| middleware(&topic.name, "publisher", error.to_string()))?;
        Ok(DdsPublisher {
            topic,
            writer,
            _bus: bus.clone(),
        })
    }

    /// Publishes in ROS 2 form. Allocates, and may wait for a short time on
    /// reliable topics: not for the control path.
    ///
    /// # Errors
    ///
    /// [`PublishError::Encode`], [`PublishError::Middleware`].
    pub fn publish(&mut self, _now: Time, message: &M) -> Result<(), PublishError> {
        let ros = message.to_ros();
        cdr::length(&ros).map_err(|source| PublishError::Encode {
            topic: self.topic.name,
            source,
        })?;
        self.writer
            .publish(ros)
            .map_err(|error| PublishError::Middleware {
                transport: "DDS",
                topic: self.topic.name,
                reason: error.to_string(),
            })
    }
}

impl<M: Message> fmt::Debug for DdsPublisher<M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("DdsPublisher")
            .field("topic", &self.topic.name)
            .finish_non_exhaustive()
    }
}
