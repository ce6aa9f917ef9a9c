//! Publishing into a recording.

use std::marker::PhantomData;

use ferntast_bag::{ChannelId, WriteBagError};
use ferntast_msgs::{
    Message, Time,
    topics::{Topic, TopicName},
};

use super::shared::SharedWriter;
use crate::error::PublishError;

/// Sends on one topic of a recording. It keeps the recording open.
#[derive(Debug)]
pub struct McapPublisher<M: Message> {
    writer: SharedWriter,
    topic: TopicName,
    channel: ChannelId,
    message: PhantomData<fn(M)>,
}

impl<M: Message> McapPublisher<M> {
    pub(super) fn new(
        writer: SharedWriter,
        topic: Topic<M>,
        channel: ChannelId,
    ) -> McapPublisher<M> {
        McapPublisher {
            writer,
            topic: topic.name,
            channel,
            message: PhantomData,
        }
    }

    /// Records `message` as logged and published at `now`.
    ///
    /// # Errors
    ///
    /// [`PublishError`]; the publisher stays usable.
    pub fn publish(&mut self, now: Time, message: &M) -> Result<(), PublishError> {
        let refused = |reason: String| PublishError::Recording {
            topic: self.topic,
            reason,
        };
        let mut guard = self.writer.lock();
        let Some(writer) = guard.as_mut() else {
            return Err(refused("it is closed".to_owned()));
        };
        writer
            .write(self.channel, now, now, message)
            .map_err(|error| match error {
                WriteBagError::Encode { source, .. } => PublishError::Encode {
                    topic: self.topic,
                    source,
                },
                error => refused(error.to_string()),
            })
    }
}
