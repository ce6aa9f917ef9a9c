//! Sending through shared memory.

use std::sync::Arc;

use ferntast_msgs::{
    Message, Time,
    topics::{Delivery, Topic},
};
use iceoryx2::port::publisher::{Publisher, PublisherCreateError};

use super::{
    MAX_PUBLISHERS, Service, SharedMemoryBus, free_memory,
    late_joiners::ConnectionUpdater,
    payload::Payload,
    service::{self, Factory},
};
use crate::error::{CreateError, PublishError};

/// Sends on one topic in shared memory.
#[derive(Debug)]
pub struct SharedMemoryPublisher<M: Message> {
    topic: Topic<M>,
    port: Arc<Publisher<Service, Payload<M>, ()>>,
    sent: u64,
    // Kept: the thread that serves late joiners, and the service.
    _connections: Arc<ConnectionUpdater>,
    _service: Factory<M>,
}

impl<M: Message> SharedMemoryPublisher<M> {
    pub(super) fn create(
        bus: &SharedMemoryBus,
        topic: Topic<M>,
    ) -> Result<SharedMemoryPublisher<M>, CreateError> {
        free_memory::check_for_publisher(topic)?;
        let service = service::open(bus, topic, "publisher")?;
        let port = service
            .publisher_builder()
            .max_loaned_samples(1)
            .create()
            .map_err(|error| match error {
                PublisherCreateError::ExceedsMaxSupportedPublishers => CreateError::TooMany {
                    topic: topic.name.into(),
                    what: "publisher",
                    limit: MAX_PUBLISHERS,
                },
                PublisherCreateError::UnableToCreateDataSegment => CreateError::NoRoom {
                    topic: topic.name.into(),
                    reason: error.to_string(),
                },
                _ => CreateError::Middleware {
                    transport: "shared memory",
                    topic: topic.name.into(),
                    what: "publisher",
                    reason: error.to_string(),
                },
            })?;
        let port = Arc::new(port);
        if topic.delivery == Delivery::State {
            bus.connections
                .serve(&port)
                .map_err(|error| CreateError::Middleware {
                    transport: "shared memory",
                    topic: topic.name.into(),
                    what: "publisher",
                    reason: format!("the thread for late joiners does not start: {error}"),
                })?;
        }
        Ok(SharedMemoryPublisher {
            topic,
            port,
            sent: 0,
            _connections: bus.connections.clone(),
            _service: service,
        })
    }

    /// Publishes, and waits for nobody. Inside, iceoryx2 allocates one small
    /// block and frees it again; a subscriber that joins costs more, once.
    ///
    /// # Errors
    ///
    /// [`PublishError::NoPlace`], [`PublishError::Middleware`].
    pub fn publish(&mut self, now: Time, message: &M) -> Result<(), PublishError> {
        let place = self
            .port
            .loan_uninit()
            .map_err(|error| PublishError::NoPlace {
                topic: self.topic.name,
                reason: error.to_string(),
            })?;
        let sample = place.write_payload(Payload {
            published: now.nanos(),
            number: self.sent,
            message: *message,
        });
        self.sent += 1;
        sample
            .send()
            .map(|_receivers| ())
            .map_err(|error| PublishError::Middleware {
                transport: "shared memory",
                topic: self.topic.name,
                reason: error.to_string(),
            })
    }
}
