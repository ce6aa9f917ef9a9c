//! Sending over DDS.

use std::fmt;

use ferntast_msgs::{
    Message, RosMessage, Time,
    topics::{Delivery, Topic},
};

use super::{DdsBus, create_topic, middleware, qos::qos, writer::Writer};
use crate::error::{CreateError, PublishError};

/// Sends on one topic over DDS.
pub struct DdsPublisher<M: Message> {
    topic: Topic<M>,
    writer: Writer,
}

impl<M: Message> DdsPublisher<M> {
    pub(super) fn create(bus: &DdsBus, topic: Topic<M>) -> Result<DdsPublisher<M>, CreateError> {
        let mut node = bus.node();
        let ros_topic = create_topic(&node, topic, &qos(topic.delivery), "publisher")?;
        let kept = match topic.delivery {
            Delivery::State => Some(1),
            Delivery::Stream | Delivery::Event => None,
        };
        let writer = Writer::new(bus, &mut node, &ros_topic, kept)
            .map_err(|reason| middleware(&topic.name, "publisher", reason))?;
        Ok(DdsPublisher { topic, writer })
    }

    /// Publishes in ROS 2 form. Allocates, and may wait for a short time on
    /// reliable topics: not for the control path.
    ///
    /// # Errors
    ///
    /// [`PublishError::Encode`], [`PublishError::Middleware`].
    pub fn publish(&mut self, _now: Time, message: &M) -> Result<(), PublishError> {
        let mut bytes = Vec::new();
        let encoded = message.to_ros().encode(&mut bytes);
        encoded.map_err(|source| PublishError::Encode {
            topic: self.topic.name,
            source,
        })?;
        self.writer
            .write(bytes)
            .map_err(|reason| PublishError::Middleware {
                transport: "DDS",
                topic: self.topic.name,
                reason,
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
