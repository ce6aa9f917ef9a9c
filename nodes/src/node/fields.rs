//! What may stand in a node's input and output, and how it meets the topics of
//! a bus.

use ferntast_bus::{Bus, CreateError, Depth, Publisher, Subscriber, SubscriberCounts};
use ferntast_msgs::{
    Message, Time,
    sample::JointNames,
    topics::{JointTopic, Topic, TopicName},
};

use super::{Batch, Newest, PerJoint, input::BATCH};

/// A field of an input: [`Newest`], [`Batch`], or [`PerJoint`] of one of them.
pub trait Incoming: Default {
    /// The row of the table of topics that it is filled from.
    type Topic;
    /// What fills it.
    type Port;

    /// Opens what fills it, on an arm of those joints.
    ///
    /// # Errors
    ///
    /// As [`Bus::subscriber`]; a joint's name that cannot be part of a topic's.
    fn open(bus: &Bus, joints: &JointNames, topic: Self::Topic) -> Result<Self::Port, CreateError>;

    /// Fills it with what is visible at `now`.
    fn fill(&mut self, now: Time, port: &mut Self::Port);

    /// Tells `each` the name of every topic and what became of its messages.
    fn counts(port: &Self::Port, each: &mut dyn FnMut(&TopicName, &SubscriberCounts));
}

/// Receives one topic, and knows its name.
#[derive(Debug)]
pub struct InputPort<M: Message> {
    topic: TopicName,
    subscriber: Subscriber<M>,
}

impl<M: Message> InputPort<M> {
    fn open(bus: &Bus, topic: Topic<M>, depth: Depth) -> Result<InputPort<M>, CreateError> {
        Ok(InputPort {
            topic: topic.name,
            subscriber: bus.subscriber(topic, depth)?,
        })
    }

    fn counts(&self, each: &mut dyn FnMut(&TopicName, &SubscriberCounts)) {
        each(&self.topic, self.subscriber.counts());
    }
}

impl<M: Message> Incoming for Newest<M> {
    type Topic = Topic<M>;
    type Port = InputPort<M>;

    fn open(bus: &Bus, _: &JointNames, topic: Topic<M>) -> Result<InputPort<M>, CreateError> {
        InputPort::open(bus, topic, Depth::Newest)
    }

    fn fill(&mut self, now: Time, port: &mut InputPort<M>) {
        self.fresh = false;
        port.subscriber.newest_to(now, |own| {
            self.message = Some(*own.message);
            self.received = own.received;
            self.fresh = true;
        });
    }

    fn counts(port: &InputPort<M>, each: &mut dyn FnMut(&TopicName, &SubscriberCounts)) {
        port.counts(each);
    }
}

impl<M: Message> Incoming for Batch<M> {
    type Topic = Topic<M>;
    type Port = InputPort<M>;

    fn open(bus: &Bus, _: &JointNames, topic: Topic<M>) -> Result<InputPort<M>, CreateError> {
        InputPort::open(bus, topic, Depth::Queue(BATCH * 4))
    }

    fn fill(&mut self, now: Time, port: &mut InputPort<M>) {
        self.clear();
        while !self.is_full() {
            match port.subscriber.next(now) {
                Some(received) => self.push(received.message),
                None => break,
            }
        }
    }

    fn counts(port: &InputPort<M>, each: &mut dyn FnMut(&TopicName, &SubscriberCounts)) {
        port.counts(each);
    }
}

impl<M: Message, F: Incoming<Topic = Topic<M>>> Incoming for PerJoint<F> {
    type Topic = JointTopic<M>;
    type Port = Vec<F::Port>;

    fn open(
        bus: &Bus,
        joints: &JointNames,
        topic: JointTopic<M>,
    ) -> Result<Vec<F::Port>, CreateError> {
        let topics = topic.of_joints(joints)?.into_iter();
        topics.map(|topic| F::open(bus, joints, topic)).collect()
    }

    fn fill(&mut self, now: Time, ports: &mut Vec<F::Port>) {
        for (field, port) in self.iter_mut().zip(ports) {
            field.fill(now, port);
        }
    }

    fn counts(ports: &Vec<F::Port>, each: &mut dyn FnMut(&TopicName, &SubscriberCounts)) {
        for port in ports {
            F::counts(port, each);
        }
    }
}

/// What a field of an output is declared by: a message, or [`PerJoint`] of one.
pub trait Outgoing {
    /// The field: what to publish after a step.
    type Field: Default;
    /// The row of the table of topics that it is published on.
    type Topic;
    /// What publishes it.
    type Port;

    /// Opens what publishes it, on an arm of those joints.
    ///
    /// # Errors
    ///
    /// As [`Bus::publisher`]; a joint's name that cannot be part of a topic's.
    fn open(bus: &Bus, joints: &JointNames, topic: Self::Topic) -> Result<Self::Port, CreateError>;

    /// Publishes what is in `field`; gives how many messages could not be sent.
    fn send(port: &mut Self::Port, now: Time, field: &Self::Field) -> u64;

    /// Empties `field`.
    fn clear(field: &mut Self::Field);
}

impl<M: Message> Outgoing for M {
    type Field = Option<M>;
    type Topic = Topic<M>;
    type Port = Publisher<M>;

    fn open(bus: &Bus, _: &JointNames, topic: Topic<M>) -> Result<Publisher<M>, CreateError> {
        bus.publisher(topic)
    }

    fn send(port: &mut Publisher<M>, now: Time, field: &Option<M>) -> u64 {
        match field {
            Some(message) => u64::from(port.publish(now, message).is_err()),
            None => 0,
        }
    }

    fn clear(field: &mut Option<M>) {
        *field = None;
    }
}

impl<M: Message> Outgoing for PerJoint<M> {
    type Field = PerJoint<Option<M>>;
    type Topic = JointTopic<M>;
    type Port = Vec<Publisher<M>>;

    fn open(
        bus: &Bus,
        joints: &JointNames,
        topic: JointTopic<M>,
    ) -> Result<Vec<Publisher<M>>, CreateError> {
        let topics = topic.of_joints(joints)?.into_iter();
        topics.map(|topic| bus.publisher(topic)).collect()
    }

    fn send(ports: &mut Vec<Publisher<M>>, now: Time, field: &PerJoint<Option<M>>) -> u64 {
        let both = ports.iter_mut().zip(field.iter());
        both.map(|(port, own)| M::send(port, now, own)).sum()
    }

    fn clear(field: &mut PerJoint<Option<M>>) {
        // Not `fill`: that may copy a whole message for each joint.
        field.iter_mut().for_each(M::clear);
    }
}
