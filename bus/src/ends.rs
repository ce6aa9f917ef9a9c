//! The ends of a topic on the ways across that bring middleware with them.
//!
//! What a middleware is to a message is a lot of code. It is compiled here, once a message
//! ([`topics::visit_samples`]), and used through [`Sends`] and [`Receives`]; else every crate
//! that opens a topic would compile all of it again.

use std::{any::Any, fmt};

use ferntast_msgs::{
    Message, Time,
    topics::{self, SampleVisitor, Topic},
};

use crate::{
    Bus,
    dds::{DdsPublisher, DdsSubscriber},
    error::{CreateError, PublishError},
    foxglove::FoxglovePublisher,
    mcap::{McapPublisher, McapSubscriber},
    memory::{MemoryPublisher, MemorySubscriber},
    shared_memory::{SharedMemoryPublisher, SharedMemorySubscriber},
    types::{Depth, Received, SubscriberCounts, type_name},
    zenoh_ros::{ZenohPublisher, ZenohSubscriber},
};

/// Sends messages on one topic.
pub trait Sends<M: Message>: fmt::Debug + Send {
    /// As [`Publisher::publish`](crate::Publisher::publish).
    ///
    /// # Errors
    ///
    /// [`PublishError`]; the publisher stays usable.
    fn publish(&mut self, now: Time, message: &M) -> Result<(), PublishError>;
}

/// Receives messages of one topic.
pub trait Receives<M: Message>: fmt::Debug + Send {
    /// As [`Subscriber::newest`](crate::Subscriber::newest).
    fn newest(&mut self, now: Time) -> Option<Received<M>>;

    /// As [`Subscriber::next`](crate::Subscriber::next).
    fn next(&mut self, now: Time) -> Option<Received<M>>;

    /// As [`Subscriber::counts`](crate::Subscriber::counts).
    fn counts(&self) -> &SubscriberCounts;
}

macro_rules! sends {
    ($($publisher:ident),*) => {
        $(impl<M: Message> Sends<M> for $publisher<M> {
            fn publish(&mut self, now: Time, message: &M) -> Result<(), PublishError> {
                $publisher::publish(self, now, message)
            }
        })*
    };
}

macro_rules! receives {
    ($($subscriber:ident),*) => {
        $(impl<M: Message> Receives<M> for $subscriber<M> {
            fn newest(&mut self, now: Time) -> Option<Received<M>> {
                $subscriber::newest(self, now)
            }

            fn next(&mut self, now: Time) -> Option<Received<M>> {
                $subscriber::next(self, now)
            }

            fn counts(&self) -> &SubscriberCounts {
                $subscriber::counts(self)
            }
        })*
    };
}

sends!(
    MemoryPublisher,
    SharedMemoryPublisher,
    DdsPublisher,
    ZenohPublisher,
    McapPublisher,
    FoxglovePublisher
);
receives!(
    MemorySubscriber,
    SharedMemorySubscriber,
    DdsSubscriber,
    ZenohSubscriber,
    McapSubscriber
);

/// A publisher on `topic`.
///
/// # Errors
///
/// As [`Bus::publisher`].
pub(crate) fn publisher<M: Message>(
    bus: &Bus,
    topic: Topic<M>,
) -> Result<Box<dyn Sends<M>>, CreateError> {
    of_type::<M, _>(open(bus, &topic, End::Publisher), &topic)
}

/// A subscriber on `topic` that keeps `depth` messages.
///
/// # Errors
///
/// As [`Bus::subscriber`].
pub(crate) fn subscriber<M: Message>(
    bus: &Bus,
    topic: Topic<M>,
    depth: Depth,
) -> Result<Box<dyn Receives<M>>, CreateError> {
    of_type::<M, _>(open(bus, &topic, End::Subscriber(depth)), &topic)
}

/// What was opened, as what it is.
fn of_type<M: Message, T: 'static>(
    opened: Option<Result<Box<dyn Any>, CreateError>>,
    topic: &Topic<M>,
) -> Result<T, CreateError> {
    let opened = opened.transpose()?.and_then(|end| end.downcast().ok());
    match opened {
        Some(end) => Ok(*end),
        None => Err(CreateError::NoSample {
            topic: topic.name.into(),
            sample: type_name::<M>(),
        }),
    }
}

#[derive(Clone, Copy)]
enum End {
    Publisher,
    Subscriber(Depth),
}

/// Opens an end of `topic`, a [`Topic`] of one of the samples: a boxed [`Sends`] or [`Receives`]
/// of that sample. `None` where it is of none of them.
fn open(bus: &Bus, topic: &dyn Any, end: End) -> Option<Result<Box<dyn Any>, CreateError>> {
    let mut opening = Opening {
        bus,
        topic,
        end,
        opened: None,
    };
    topics::visit_samples(&mut opening);
    opening.opened
}

struct Opening<'a> {
    bus: &'a Bus,
    topic: &'a dyn Any,
    end: End,
    opened: Option<Result<Box<dyn Any>, CreateError>>,
}

impl SampleVisitor for Opening<'_> {
    fn sample<M: Message>(&mut self) {
        let Some(&topic) = self.topic.downcast_ref::<Topic<M>>() else {
            return;
        };
        if self.opened.is_some() {
            return;
        }
        self.opened = Some(match self.end {
            End::Publisher => sender(self.bus, topic).map(|end| Box::new(end) as Box<dyn Any>),
            End::Subscriber(depth) => {
                receiver(self.bus, topic, depth).map(|end| Box::new(end) as Box<dyn Any>)
            }
        });
    }
}

fn sender<M: Message>(bus: &Bus, topic: Topic<M>) -> Result<Box<dyn Sends<M>>, CreateError> {
    Ok(match bus {
        Bus::Memory(bus) => Box::new(bus.publisher(topic)?),
        Bus::SharedMemory(bus) => Box::new(bus.publisher(topic)?),
        Bus::Dds(bus) => Box::new(bus.publisher(topic)?),
        Bus::Zenoh(bus) => Box::new(bus.publisher(topic)?),
        Bus::Mcap(bus) => Box::new(bus.publisher(topic)?),
        Bus::Foxglove(bus) => Box::new(bus.publisher(topic)?),
    })
}

fn receiver<M: Message>(
    bus: &Bus,
    topic: Topic<M>,
    depth: Depth,
) -> Result<Box<dyn Receives<M>>, CreateError> {
    Ok(match bus {
        Bus::Memory(bus) => Box::new(bus.subscriber(topic, depth)?),
        Bus::SharedMemory(bus) => Box::new(bus.subscriber(topic, depth)?),
        Bus::Dds(bus) => Box::new(bus.subscriber(topic, depth)?),
        Bus::Zenoh(bus) => Box::new(bus.subscriber(topic, depth)?),
        Bus::Mcap(bus) => Box::new(bus.subscriber(topic, depth)?),
        Bus::Foxglove(_) => {
            return Err(CreateError::OneWay {
                topic: topic.name.into(),
            });
        }
    })
}
