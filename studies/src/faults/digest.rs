//! A number that stands for all that was published.

use std::{
    fmt::Write,
    hash::{DefaultHasher, Hasher},
};

use ferntast_bus::{Bus, CreateError, Depth, Subscriber};
use ferntast_msgs::{
    Message, Time,
    sample::JointNames,
    topics::{self, EVENT_QUEUE, JointNameError, Topic, Visitor},
};

/// Adds every message to the number.
#[derive(Default)]
pub struct Digest {
    taps: Vec<Box<dyn Tap>>,
    hasher: DefaultHasher,
}

trait Tap {
    fn take(&mut self, now: Time, into: &mut Hashed<'_>);
}

struct Tapped<M: Message>(Subscriber<M>);

/// Text that goes into a number.
struct Hashed<'a>(&'a mut DefaultHasher);

impl Write for Hashed<'_> {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        self.0.write(text.as_bytes());
        Ok(())
    }
}

impl<M: Message> Tap for Tapped<M> {
    fn take(&mut self, now: Time, into: &mut Hashed<'_>) {
        while let Some(own) = self.0.next(now) {
            // A number takes every text. Two numbers are written alike only if
            // they are the same.
            let _ = write!(into, "{}{:?}", own.received.nanos(), own.message);
        }
    }
}

/// Why there is no number.
#[derive(Debug, thiserror::Error)]
pub enum DigestError {
    /// A topic cannot be opened.
    #[error(transparent)]
    Create(#[from] CreateError),
    /// A joint that topics cannot name.
    #[error(transparent)]
    Joint(#[from] JointNameError),
}

impl Digest {
    /// Adds what is published on `bus` from now on.
    ///
    /// # Errors
    ///
    /// A topic that cannot be opened.
    pub fn add(&mut self, bus: &Bus, joints: &JointNames) -> Result<(), DigestError> {
        struct Add<'a> {
            bus: &'a Bus,
            taps: &'a mut Vec<Box<dyn Tap>>,
            result: Result<(), CreateError>,
        }
        impl Visitor for Add<'_> {
            fn topic<M: Message>(&mut self, topic: Topic<M>) {
                match self.bus.subscriber(topic, Depth::Queue(EVENT_QUEUE)) {
                    Ok(own) => self.taps.push(Box::new(Tapped(own))),
                    Err(error) => self.result = Err(error),
                }
            }
        }
        let mut add = Add {
            bus,
            taps: &mut self.taps,
            result: Ok(()),
        };
        topics::visit(joints, &mut add)?;
        Ok(add.result?)
    }

    /// Takes in what was published before `now`.
    pub fn take(&mut self, now: Time) {
        for tap in &mut self.taps {
            tap.take(now, &mut Hashed(&mut self.hasher));
        }
    }

    /// The number.
    pub fn value(&self) -> u64 {
        self.hasher.finish()
    }
}
