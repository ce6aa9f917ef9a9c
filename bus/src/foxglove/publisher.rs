//! Publishing to Foxglove.

use std::{fmt, sync::Arc};

use ferntast_msgs::{
    Message, RosMessage, Time, interface,
    topics::{Delivery, Topic},
};
use foxglove::{ChannelBuilder, PartialMetadata, RawChannel, Schema};

use super::FoxgloveBus;
use crate::error::{CreateError, PublishError};

/// Sends on one topic to Foxglove's clients.
pub struct FoxglovePublisher<M: Message> {
    bus: FoxgloveBus,
    topic: Topic<M>,
    channel: Arc<RawChannel>,
    bytes: Vec<u8>,
}

impl<M: Message> FoxglovePublisher<M> {
    pub(super) fn create(
        bus: &FoxgloveBus,
        topic: Topic<M>,
    ) -> Result<FoxglovePublisher<M>, CreateError> {
        let failed = |reason: String| CreateError::Middleware {
            transport: "a WebSocket for Foxglove",
            topic: topic.name.into(),
            what: "publisher",
            reason,
        };
        let interface = M::Ros::INTERFACE;
        let schema = interface::schema(interface).map_err(|error| failed(error.to_string()))?;
        let channel = ChannelBuilder::new(topic.name)
            .context(&bus.0.context)
            .message_encoding("cdr")
            .schema(Schema::new(interface, "ros2msg", schema.into_bytes()))
            .build_raw()
            .map_err(|error| failed(error.to_string()))?;
        Ok(FoxglovePublisher {
            bus: bus.clone(),
            topic,
            channel,
            bytes: Vec::new(),
        })
    }

    /// Publishes in ROS 2 form, logged at `now`. A client that is too slow
    /// loses its oldest messages. Allocates: not for the control path.
    ///
    /// # Errors
    ///
    /// [`PublishError::Encode`].
    pub fn publish(&mut self, now: Time, message: &M) -> Result<(), PublishError> {
        let state = self.topic.delivery == Delivery::State;
        if !state && !self.channel.has_sinks() {
            return Ok(());
        }
        let encoded = message.to_ros().encode(&mut self.bytes);
        encoded.map_err(|source| PublishError::Encode {
            topic: self.topic.name,
            source,
        })?;
        let bytes = &self.bytes;
        let log = |channel: &RawChannel| {
            // Times before 1970 are none.
            let log_time = u64::try_from(now.nanos()).ok();
            channel.log_with_meta(bytes, PartialMetadata { log_time });
        };
        if state {
            self.bus.0.last.send(&self.channel, bytes, log);
        } else {
            log(&self.channel);
        }
        Ok(())
    }
}

impl<M: Message> fmt::Debug for FoxglovePublisher<M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("FoxglovePublisher")
            .field("topic", &self.topic.name)
            .finish_non_exhaustive()
    }
}
