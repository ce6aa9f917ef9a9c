//! The one interface to all ways across.

use ferntast_msgs::{Message, Time, topics::Topic};

use crate::{
    dds::DdsBus,
    ends::{self, Receives, Sends},
    error::{CreateError, PublishError},
    foxglove::FoxgloveBus,
    mcap::McapBus,
    memory::{MemoryBus, MemoryPublisher, MemorySubscriber},
    shared_memory::SharedMemoryBus,
    types::{Depth, Received, SubscriberCounts},
    zenoh_ros::ZenohBus,
};

/// A way across. A clone is another handle to the same bus.
#[derive(Clone, Debug)]
pub enum Bus {
    /// Within this process, in virtual time: lockstep and tests.
    Memory(MemoryBus),
    /// Between processes of one host, over iceoryx2.
    SharedMemory(SharedMemoryBus),
    /// ROS 2 over DDS.
    Dds(DdsBus),
    /// ROS 2 over Zenoh, wire-compatible with rmw_zenoh.
    Zenoh(ZenohBus),
    /// A recording.
    Mcap(McapBus),
    /// To Foxglove, one way.
    Foxglove(FoxgloveBus),
}

impl Bus {
    /// The topics of others that discovery has found so far, each with its
    /// type; always empty on the ways that know no discovery.
    pub fn topics_seen(&self) -> Vec<(String, String)> {
        match self {
            Bus::Memory(_) | Bus::SharedMemory(_) | Bus::Mcap(_) | Bus::Foxglove(_) => Vec::new(),
            Bus::Dds(bus) => bus.topics_seen(),
            Bus::Zenoh(bus) => bus.topics_seen(),
        }
    }

    /// A publisher on `topic`, with the quality of service that the topic's delivery asks for.
    ///
    /// # Errors
    ///
    /// [`CreateError`]. A type that the topic does not carry is refused by
    /// memory, shared memory and recordings; on ROS 2, where anyone may
    /// offer anything under any name, endpoints of unlike types never meet.
    pub fn publisher<M: Message>(&self, topic: Topic<M>) -> Result<Publisher<M>, CreateError> {
        Ok(match self {
            Bus::Memory(bus) => Publisher::Memory(bus.publisher(topic)?),
            others => Publisher::Other(ends::publisher(others, topic)?),
        })
    }

    /// A subscriber on `topic` that keeps `depth` messages. On a
    /// [`State`](ferntast_msgs::topics::Delivery::State) topic it begins with
    /// the last message, on the others with the next one.
    ///
    /// # Errors
    ///
    /// As [`Bus::publisher`].
    pub fn subscriber<M: Message>(
        &self,
        topic: Topic<M>,
        depth: Depth,
    ) -> Result<Subscriber<M>, CreateError> {
        Ok(match self {
            Bus::Memory(bus) => Subscriber::Memory(bus.subscriber(topic, depth)?),
            others => Subscriber::Other(ends::subscriber(others, topic, depth)?),
        })
    }
}

/// Sends messages on one topic.
#[derive(Debug)]
pub enum Publisher<M: Message> {
    /// Within this process: lockstep runs through it, so it is compiled where it is used.
    Memory(MemoryPublisher<M>),
    /// Any other way across.
    Other(Box<dyn Sends<M>>),
}

impl<M: Message> Publisher<M> {
    /// Publishes `message` at time `now`. Memory and shared memory wait for
    /// nobody and may be used by control loops; memory does not allocate,
    /// shared memory allocates one small block inside iceoryx2.
    ///
    /// # Errors
    ///
    /// [`PublishError`]; the publisher stays usable.
    pub fn publish(&mut self, now: Time, message: &M) -> Result<(), PublishError> {
        match self {
            Publisher::Memory(publisher) => publisher.publish(now, message),
            Publisher::Other(publisher) => publisher.publish(now, message),
        }
    }
}

/// Receives messages of one topic. What [`Message::check`] refuses is counted and never handed out.
#[derive(Debug)]
pub enum Subscriber<M: Message> {
    /// Within this process.
    Memory(MemorySubscriber<M>),
    /// Any other way across.
    Other(Box<dyn Receives<M>>),
}

impl<M: Message> Subscriber<M> {
    /// The newest message visible at `now` that was not taken yet; older ones are dropped.
    ///
    /// Memory and recordings: visible is what was published before `now`.
    /// The others: visible is what has arrived.
    pub fn newest(&mut self, now: Time) -> Option<Received<M>> {
        match self {
            Subscriber::Memory(subscriber) => subscriber.newest(now),
            Subscriber::Other(subscriber) => subscriber.newest(now),
        }
    }

    /// The same as `take` takes it from where it lies: in memory a long message is copied
    /// once. Nobody publishes on the topic meanwhile.
    pub fn newest_to<R>(&mut self, now: Time, take: impl FnOnce(Received<&M>) -> R) -> Option<R> {
        match self {
            Subscriber::Memory(subscriber) => subscriber.newest_to(now, take),
            Subscriber::Other(subscriber) => {
                let own = subscriber.newest(now)?;
                Some(take(Received {
                    message: &own.message,
                    received: own.received,
                    source: own.source,
                }))
            }
        }
    }

    /// The oldest message visible at `now` that was not taken yet.
    pub fn next(&mut self, now: Time) -> Option<Received<M>> {
        match self {
            Subscriber::Memory(subscriber) => subscriber.next(now),
            Subscriber::Other(subscriber) => subscriber.next(now),
        }
    }

    /// What was handed out, refused and dropped so far.
    pub fn counts(&self) -> &SubscriberCounts {
        match self {
            Subscriber::Memory(subscriber) => subscriber.counts(),
            Subscriber::Other(subscriber) => subscriber.counts(),
        }
    }
}

#[cfg(test)]
mod tests {
    use ferntast_msgs::sample::JointSample;

    use super::*;

    /// Compiles only if so: a node may run its loop in any thread.
    #[test]
    fn ports_go_to_other_threads() {
        fn sent<T: Send>() {}
        fn shared<T: Send + Sync + Clone>() {}
        shared::<Bus>();
        sent::<Publisher<JointSample>>();
        sent::<Subscriber<JointSample>>();
        sent::<crate::frames::FrameSender>();
        sent::<crate::frames::FrameReceiver>();
    }
}
