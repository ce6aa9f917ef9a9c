//! Receiving through shared memory.

use ferntast_msgs::{Message, Time, topics::Topic};
use iceoryx2::port::subscriber::{Subscriber, SubscriberCreateError};

use super::{
    MAX_SUBSCRIBERS, Service, SharedMemoryBus,
    payload::Payload,
    service::{self, Factory},
};
use crate::{
    error::CreateError,
    sequence_gaps::SequenceGaps,
    types::{Depth, Received, SubscriberCounts},
};

/// Receives from one topic in shared memory.
#[derive(Debug)]
pub struct SharedMemorySubscriber<M: Message> {
    port: Subscriber<Service, Payload<M>, ()>,
    depth: Depth,
    counts: SubscriberCounts,
    gaps: SequenceGaps,
    _service: Factory<M>,
}

impl<M: Message> SharedMemorySubscriber<M> {
    pub(super) fn create(
        bus: &SharedMemoryBus,
        topic: Topic<M>,
        depth: Depth,
    ) -> Result<SharedMemorySubscriber<M>, CreateError> {
        let limit = SharedMemoryBus::max_queue(topic.delivery);
        if !(1..=limit).contains(&depth.places()) {
            return Err(CreateError::BadDepth {
                topic: topic.name.into(),
                depth: depth.places(),
                limit,
            });
        }
        let service = service::open(bus, topic, "subscriber")?;
        let port = service
            .subscriber_builder()
            .buffer_size(depth.places())
            .history_request(service::history(topic.delivery))
            .create()
            .map_err(|error| match error {
                SubscriberCreateError::ExceedsMaxSupportedSubscribers => CreateError::TooMany {
                    topic: topic.name.into(),
                    what: "subscriber",
                    limit: MAX_SUBSCRIBERS,
                },
                _ => CreateError::Middleware {
                    transport: "shared memory",
                    topic: topic.name.into(),
                    what: "subscriber",
                    reason: error.to_string(),
                },
            })?;
        Ok(SharedMemorySubscriber {
            port,
            depth,
            counts: SubscriberCounts::default(),
            gaps: SequenceGaps::default(),
            _service: service,
        })
    }

    /// The newest message that has arrived and was not taken yet.
    pub fn newest(&mut self, _now: Time) -> Option<Received<M>> {
        let mut newest: Option<Payload<M>> = None;
        while let Some(payload) = self.receive() {
            // Several publishers' messages do not come in the order of their times.
            let newer = newest.is_none_or(|newest| payload.published >= newest.published);
            if self.counts.valid(&payload.message) && newer {
                newest = Some(payload);
            }
        }
        Some(self.hand_out(newest?))
    }

    /// The oldest message that has arrived and was not taken yet.
    pub fn next(&mut self, now: Time) -> Option<Received<M>> {
        if self.depth == Depth::Newest {
            return self.newest(now);
        }
        loop {
            let payload = self.receive()?;
            if self.counts.valid(&payload.message) {
                return Some(self.hand_out(payload));
            }
        }
    }

    /// What was handed out, refused and dropped so far.
    pub fn counts(&self) -> &SubscriberCounts {
        &self.counts
    }

    fn receive(&mut self) -> Option<Payload<M>> {
        // A connection that broke (its publisher died) reads as nothing
        // there; the other publishers' messages come all the same.
        let sample = self.port.receive().ok().flatten()?;
        let payload = *sample.payload();
        let publisher = sample.header().publisher_id().value();
        let lost = self.gaps.before(publisher, payload.number);
        if let Depth::Queue(_) = self.depth {
            self.counts.overflowed += lost;
        }
        Some(payload)
    }

    fn hand_out(&mut self, payload: Payload<M>) -> Received<M> {
        self.counts.delivered += 1;
        Received {
            message: payload.message,
            received: Time::from_nanos(payload.published),
            source: 0,
        }
    }
}
