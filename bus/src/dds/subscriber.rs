//! Receiving over DDS.

use std::{collections::VecDeque, fmt};

use ferntast_msgs::{
    Message, RosMessage, Time,
    cdr::{DecodeError, EncodeError},
    topics::Topic,
};
use ros2_client::{MessageInfo, ReadError, Subscription, qos::History};

use super::{DdsBus, MAX_QUEUE, create_topic, middleware, qos::qos, senders::Senders, type_name};
use crate::{
    error::CreateError,
    sequence_gaps::{self, SequenceGaps},
    types::{Depth, Received, SubscriberCounts},
};

/// Receives from one topic over DDS.
pub struct DdsSubscriber<M: Message> {
    topic: Topic<M>,
    reader: Subscription<M::Ros>,
    depth: Depth,
    waiting: VecDeque<Received<M>>,
    counts: SubscriberCounts,
    gaps: SequenceGaps,
    senders: Senders,
    // Kept: a reader without its participant is dead.
    _bus: DdsBus,
}

impl<M: Message> DdsSubscriber<M> {
    pub(super) fn create(
        bus: &DdsBus,
        topic: Topic<M>,
        depth: Depth,
    ) -> Result<DdsSubscriber<M>, CreateError> {
        if !(1..=MAX_QUEUE).contains(&depth.places()) {
            return Err(CreateError::BadDepth {
                topic: topic.name.into(),
                depth: depth.places(),
                limit: MAX_QUEUE,
            });
        }
        // How much a reader keeps is its own affair: writers of another depth match.
        let asked = qos(topic.delivery).history(History::KeepLast {
            depth: depth.places(),
        });
        let mut node = bus.node();
        let ros_topic = create_topic(&node, topic, &asked, "subscriber")?;
        let reader = node
            .create_subscription(&ros_topic, Some(asked))
            .map_err(|error| middleware(&topic.name, "subscriber", error.to_string()))?;
        Ok(DdsSubscriber {
            topic,
            reader,
            depth,
            waiting: VecDeque::with_capacity(depth.places()),
            counts: SubscriberCounts::default(),
            gaps: SequenceGaps::default(),
            senders: Senders::new(bus.participant.clone(), type_name::<M>().dds_msg_type()),
            _bus: bus.clone(),
        })
    }

    /// The newest message that has arrived and was not taken yet.
    pub fn newest(&mut self, _now: Time) -> Option<Received<M>> {
        self.collect();
        let newest = self.waiting.pop_back()?;
        self.waiting.clear();
        self.counts.delivered += 1;
        Some(newest)
    }

    /// The oldest message that has arrived and was not taken yet.
    pub fn next(&mut self, _now: Time) -> Option<Received<M>> {
        self.collect();
        let oldest = self.waiting.pop_front()?;
        self.counts.delivered += 1;
        Some(oldest)
    }

    /// What was handed out, refused and dropped so far. Dropped are those that
    /// found the queue full, and the numbers missing from each sender's sequence.
    pub fn counts(&self) -> &SubscriberCounts {
        &self.counts
    }

    /// Moves what RustDDS holds into the queue. RustDDS keeps more than a
    /// depth of history says, so the depth is kept here.
    fn collect(&mut self) {
        loop {
            match self.reader.take() {
                Ok(None) => return,
                Ok(Some((ros, info))) => {
                    let Some(received) = self.admit(&ros, &info) else {
                        continue;
                    };
                    if self.waiting.len() == self.depth.places() {
                        self.waiting.pop_front();
                        self.lost(1);
                    }
                    self.waiting.push_back(received);
                }
                // The reader has gone past the message that it could not decode.
                Err(ReadError::Deserialization { reason, .. }) => {
                    self.not_this_type(reason);
                }
                // The participant is gone: nothing will come.
                Err(_) => return,
            }
        }
    }

    fn lost(&mut self, messages: u64) {
        if let Depth::Queue(_) = self.depth {
            self.counts.overflowed += messages;
        }
    }

    fn not_this_type(&mut self, reason: String) {
        self.counts.count(&DecodeError::NotThisType {
            interface: M::Ros::INTERFACE,
            reason,
        });
    }

    fn admit(&mut self, ros: &M::Ros, info: &MessageInfo) -> Option<Received<M>> {
        let sender = info.publisher_gid();
        if !self.senders.is_right(sender) {
            self.not_this_type("its sender offers another type".into());
            return None;
        }
        if let Ok(number) = u64::try_from(info.sequence_number()) {
            let guid = u128::from_le_bytes(sender.to_bytes16());
            let missing = self.gaps.before(guid, number);
            self.lost(missing);
        }
        // RustDDS decodes before it can be asked for the length; lengths in
        // the bytes are checked there against the bytes that came.
        match ros.encoded_length() {
            Ok(_) => {}
            Err(EncodeError::TooLarge { length, limit, .. }) => {
                self.counts.count(&DecodeError::TooLarge { length, limit });
                return None;
            }
            Err(EncodeError::NotCdr { reason, .. }) => {
                self.not_this_type(reason);
                return None;
            }
        }
        let message = match M::from_ros(ros) {
            Ok(message) => message,
            Err(error) => {
                self.counts.count(&DecodeError::Invalid(error));
                return None;
            }
        };
        if !self.counts.valid(&message) {
            return None;
        }
        Some(Received {
            message,
            received: info
                .received_timestamp()
                .map_or(Time::INVALID, |time| Time::from_nanos(time.to_nanos())),
            source: sequence_gaps::source(sender.as_bytes()),
        })
    }
}

impl<M: Message> fmt::Debug for DdsSubscriber<M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("DdsSubscriber")
            .field("topic", &self.topic.name)
            .field("counts", &self.counts)
            .finish_non_exhaustive()
    }
}
