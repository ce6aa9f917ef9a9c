//! Receiving over Zenoh.

use std::time::{SystemTime, UNIX_EPOCH};

use ferntast_msgs::{
    Message, Time,
    cdr::{self, DecodeError},
    topics::{Topic, TopicName},
};
use hiroz::{BufferGroup, Builder, attachment::Attachment, msg::SerdeCdrSerdes, pubsub::ZSub};
use zenoh::sample::Sample;

use super::{
    MAX_QUEUE, ZenohBus, middleware,
    qos::qos,
    raw::{Raw, type_info},
};
use crate::{
    error::CreateError,
    namespace::within,
    sequence_gaps::{self, SequenceGaps},
    types::{Depth, Received, SubscriberCounts},
    zenoh_words::words,
};

/// Receives from one topic over Zenoh.
#[derive(Debug)]
pub struct ZenohSubscriber<M: Message> {
    topic: Topic<M>,
    port: ZSub<Raw, Sample, SerdeCdrSerdes<Raw>>,
    depth: Depth,
    counts: SubscriberCounts,
    gaps: SequenceGaps,
    // Kept: the session.
    _bus: ZenohBus,
}

impl<M: Message> ZenohSubscriber<M> {
    pub(super) fn create(
        bus: &ZenohBus,
        topic: Topic<M>,
        depth: Depth,
    ) -> Result<ZenohSubscriber<M>, CreateError> {
        if !(1..=MAX_QUEUE).contains(&depth.places()) {
            return Err(CreateError::BadDepth {
                topic: topic.name.into(),
                depth: depth.places(),
                limit: MAX_QUEUE,
            });
        }
        let failed = |reason: String| middleware(&topic.name, "subscriber", reason);
        let type_info = type_info::<M>().map_err(failed)?;
        let port = bus
            .node
            .create_sub_impl::<Raw>(&within(bus.namespace(), &topic.name), Some(type_info))
            .with_qos(qos(topic.delivery, depth.places()))
            // For types with unbounded byte arrays; ours have none.
            .with_buffer_group(BufferGroup::Off)
            .build()
            .map_err(|error| failed(words(error)))?;
        Ok(ZenohSubscriber {
            topic,
            port,
            depth,
            counts: SubscriberCounts::default(),
            gaps: SequenceGaps::default(),
            _bus: bus.clone(),
        })
    }

    /// The newest message that has arrived and was not taken yet.
    pub fn newest(&mut self, _now: Time) -> Option<Received<M>> {
        let mut newest = None;
        while let Some(received) = self.receive() {
            newest = Some(received);
        }
        self.counts.delivered += u64::from(newest.is_some());
        newest
    }

    /// The oldest message that has arrived and was not taken yet.
    pub fn next(&mut self, now: Time) -> Option<Received<M>> {
        if self.depth == Depth::Newest {
            return self.newest(now);
        }
        let received = self.receive()?;
        self.counts.delivered += 1;
        Some(received)
    }

    /// What was handed out, refused and dropped so far. Dropped counts the
    /// numbers missing from each sender's sequence: a full queue, or loss on the way.
    pub fn counts(&self) -> &SubscriberCounts {
        &self.counts
    }

    /// The topic's full name.
    pub fn topic(&self) -> TopicName {
        self.topic.name
    }

    /// The next message that can be acted on.
    fn receive(&mut self) -> Option<Received<M>> {
        loop {
            let sample = self.port.queue.as_ref()?.try_recv()?;
            let source = self.sender(&sample);
            match decode::<M>(&sample) {
                Ok(message) => {
                    return Some(Received {
                        message,
                        received: system_time(),
                        source,
                    });
                }
                Err(error) => self.counts.count(&error),
            }
        }
    }

    /// Who sent it, by the attachment that rmw_zenoh sends along; gaps in its numbers are counted.
    fn sender(&mut self, sample: &Sample) -> u64 {
        let Some(Ok(attachment)) = sample.attachment().map(Attachment::try_from) else {
            return sequence_gaps::source(&[]);
        };
        let guid = attachment.source_gid;
        if let Ok(number) = u64::try_from(attachment.sequence_number) {
            let missing = self.gaps.before(u128::from_le_bytes(guid), number);
            if let Depth::Queue(_) = self.depth {
                self.counts.overflowed += missing;
            }
        }
        sequence_gaps::source(&guid)
    }
}

fn decode<M: Message>(sample: &Sample) -> Result<M, DecodeError> {
    let length = sample.payload().len();
    // Before the bytes are brought together, which may copy them.
    if length > cdr::MAX_LENGTH {
        return Err(DecodeError::TooLarge {
            length,
            limit: cdr::MAX_LENGTH,
        });
    }
    cdr::decode_sample(&sample.payload().to_bytes())
}

/// The system clock, for the stamp of arrival.
fn system_time() -> Time {
    SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .ok()
        .and_then(|since| i64::try_from(since.as_nanos()).ok())
        .map_or(Time::INVALID, Time::from_nanos)
}
