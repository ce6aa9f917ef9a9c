//! A writer that RustDDS cannot forget.
//!
//! RustDDS 0.15.1 sends in a loop of its own, which a writer tells of each sample. What it is
//! told of a writer that it has not taken up yet, it drops. If as many samples as may wait
//! were written in that moment, none is left to tell it of: every further one is refused, for
//! good. Such a writer is made anew, and what late joiners would get is written again.

use std::collections::VecDeque;

use ros2_client::{
    Publisher, WriteError,
    dds::rustdds::{
        QosPolicies, Topic, TopicDescription, TopicKind, policy::ResourceLimits, qos::HasQoSPolicy,
    },
};

use super::{DdsBus, encoded::Encoded};

/// Samples of a writer that keeps some for late joiners: those that wait to be sent, and those
/// that not every reader has confirmed.
///
/// RustDDS keeps of a reliable writer of durability transient local all samples that not every
/// reader has confirmed; without a reader it takes none as confirmed, whatever the depth of
/// the history, and its own limit is 8192 samples a topic. So many are enough for readers
/// whose confirmation is on its way.
const MAX_KEPT: usize = 64;

/// Sends messages that are in CDR.
pub(super) struct Writer {
    bus: DdsBus,
    topic: Topic,
    writer: Publisher<Encoded>,
    // Of a writer that keeps messages for late joiners, until it has surely been taken up.
    first: Option<First>,
}

/// What was written before a writer is known to have been taken up.
struct First {
    /// How many may wait.
    room: usize,
    written: usize,
    /// The newest ones, as many as late joiners get.
    newest: VecDeque<Encoded>,
    depth: usize,
}

impl Writer {
    /// On a topic of that node, of which late joiners get `kept` messages; at least 1.
    ///
    /// # Errors
    ///
    /// What the middleware said.
    pub(super) fn new(
        bus: &DdsBus,
        node: &mut ros2_client::Node,
        topic: &Topic,
        kept: Option<usize>,
    ) -> Result<Writer, String> {
        let room = kept.map(|depth| depth.max(MAX_KEPT));
        // The same topic once more, with the limits that the node's has not.
        let topic = bus
            .participant
            .create_topic(
                topic.name(),
                topic.get_type().name().to_owned(),
                &limited(topic.qos(), room),
                TopicKind::NoKey,
            )
            .map_err(|error| error.to_string())?;
        let writer = node
            .create_publisher(&topic, None)
            .map_err(|error| error.to_string())?;
        Ok(Writer {
            bus: bus.clone(),
            topic,
            writer,
            first: kept.zip(room).map(|(depth, room)| First {
                room,
                written: 0,
                newest: VecDeque::with_capacity(depth.min(MAX_KEPT)),
                depth,
            }),
        })
    }

    /// Writes one message in CDR with its header.
    ///
    /// # Errors
    ///
    /// What the middleware said; the writer stays usable.
    pub(super) fn write(&mut self, message: Vec<u8>) -> Result<(), String> {
        let message = Encoded(message);
        let Some(first) = &mut self.first else {
            return published(&self.writer, message);
        };
        match self.writer.publish(message.clone()) {
            Ok(()) => {}
            Err(WriteError::WouldBlock { .. }) => {
                self.writer = (self.bus.node())
                    .create_publisher(&self.topic, None)
                    .map_err(|error| error.to_string())?;
                first.written = 0;
                for older in &first.newest {
                    published(&self.writer, older.clone())?;
                    first.written += 1;
                }
                published(&self.writer, message.clone())?;
            }
            Err(error) => return Err(error.to_string()),
        }
        if first.take(message) {
            self.first = None;
        }
        Ok(())
    }
}

impl First {
    /// Notes a message that was written; says whether so many were that some must have been
    /// sent.
    fn take(&mut self, message: Encoded) -> bool {
        self.written += 1;
        if self.newest.len() == self.depth {
            self.newest.pop_front();
        }
        self.newest.push_back(message);
        self.written > self.room
    }
}

fn published(writer: &Publisher<Encoded>, message: Encoded) -> Result<(), String> {
    writer.publish(message).map_err(|error| error.to_string())
}

/// The same policies, with room for so many samples.
fn limited(policies: QosPolicies, room: Option<usize>) -> QosPolicies {
    let Some(room) = room else { return policies };
    let most = i32::try_from(room).unwrap_or(i32::MAX);
    let limits = QosPolicies::builder().resource_limits(ResourceLimits {
        max_samples: most,
        max_instances: 1,
        max_samples_per_instance: most,
    });
    policies.modify_by(&limits.build())
}
