//! Within one process, in virtual time: lockstep and tests.
//!
//! A message published at time t is visible to reads at times later than t
//! (logical execution time), so the order in which nodes run within a tick
//! does not matter. Nothing here reads a clock, and nothing allocates once
//! publishers and subscribers stand.

mod ring;

use std::{
    any::Any,
    collections::HashMap,
    fmt,
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
};

use ferntast_msgs::{
    Message, Time,
    topics::{Delivery, Topic, TopicName},
};

use crate::{
    error::{CreateError, PublishError},
    types::{Depth, Received, SubscriberCounts, type_name},
};
use ring::{Published, Ring};

/// Longest queue of a subscriber.
pub const MAX_QUEUE: usize = 1 << 20;

/// The bus in memory. A clone is another handle to the same topics.
#[derive(Clone, Default)]
pub struct MemoryBus {
    topics: Arc<Mutex<HashMap<TopicName, Entry>>>,
    refuses: Arc<AtomicBool>,
}

/// The messages of a topic.
#[derive(Debug)]
struct Channel<M> {
    ring: Mutex<Ring<M>>,
    /// Number that the next message will get: who has seen all need not take the lock.
    end: AtomicU64,
}

impl<M: Copy> Channel<M> {
    fn new() -> Channel<M> {
        Channel {
            ring: Mutex::new(Ring::new()),
            end: AtomicU64::new(0),
        }
    }

    fn end(&self) -> u64 {
        self.end.load(Ordering::Acquire)
    }

    fn push(&self, now: Time, message: &M) {
        let mut ring = lock(&self.ring);
        ring.push(now, message);
        self.end.store(ring.end(), Ordering::Release);
    }
}

/// A topic by name; the channel is an `Arc<Channel<M>>` of the type named.
struct Entry {
    type_name: String,
    channel: Box<dyn Any + Send>,
    /// How many messages were published.
    published: Box<dyn Fn() -> u64 + Send>,
}

impl MemoryBus {
    /// A bus without topics; they come to be with their first publisher or subscriber.
    pub fn new() -> MemoryBus {
        MemoryBus::default()
    }

    /// A publisher on `topic`.
    ///
    /// # Errors
    ///
    /// [`CreateError::WrongType`].
    pub fn publisher<M: Message>(
        &self,
        topic: Topic<M>,
    ) -> Result<MemoryPublisher<M>, CreateError> {
        Ok(MemoryPublisher {
            channel: self.channel(topic)?,
            refuses: self.refuses.clone(),
        })
    }

    /// Refuses every message from now on, as a full disk does, or none.
    pub fn refuse(&self, all: bool) {
        self.refuses.store(all, Ordering::Relaxed);
    }

    /// Messages published since it was made, on all topics.
    pub fn published(&self) -> u64 {
        let topics = lock(&self.topics);
        topics.values().map(|entry| (entry.published)()).sum()
    }

    /// A subscriber on `topic`.
    ///
    /// # Errors
    ///
    /// [`CreateError::WrongType`], [`CreateError::BadDepth`].
    pub fn subscriber<M: Message>(
        &self,
        topic: Topic<M>,
        depth: Depth,
    ) -> Result<MemorySubscriber<M>, CreateError> {
        if !(1..=MAX_QUEUE).contains(&depth.places()) {
            return Err(CreateError::BadDepth {
                topic: topic.name.into(),
                depth: depth.places(),
                limit: MAX_QUEUE,
            });
        }
        let channel = self.channel(topic)?;
        let next = {
            let mut ring = lock(&channel.ring);
            ring.reserve(depth.places());
            match topic.delivery {
                Delivery::State => ring.last(),
                Delivery::Stream | Delivery::Event => ring.end(),
            }
        };
        Ok(MemorySubscriber {
            channel,
            next,
            depth,
            counts: SubscriberCounts::default(),
        })
    }

    fn channel<M: Message>(&self, topic: Topic<M>) -> Result<Arc<Channel<M>>, CreateError> {
        let mut topics = lock(&self.topics);
        let entry = topics.entry(topic.name).or_insert_with(|| {
            let channel = Arc::new(Channel::<M>::new());
            Entry {
                type_name: type_name::<M>(),
                channel: Box::new(channel.clone()),
                published: Box::new(move || channel.end()),
            }
        });
        match entry.channel.downcast_ref::<Arc<Channel<M>>>() {
            Some(channel) => Ok(channel.clone()),
            None => Err(CreateError::WrongType {
                topic: topic.name.into(),
                wanted: type_name::<M>(),
                found: entry.type_name.clone(),
            }),
        }
    }
}

impl fmt::Debug for MemoryBus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(lock(&self.topics).keys()).finish()
    }
}

/// Sends on one topic in memory.
#[derive(Debug)]
pub struct MemoryPublisher<M: Message> {
    channel: Arc<Channel<M>>,
    refuses: Arc<AtomicBool>,
}

impl<M: Message> MemoryPublisher<M> {
    /// Publishes at `now`: visible to reads later than that.
    ///
    /// # Errors
    ///
    /// Only where the bus [refuses](MemoryBus::refuse) all.
    pub fn publish(&mut self, now: Time, message: &M) -> Result<(), PublishError> {
        if self.refuses.load(Ordering::Relaxed) {
            return Err(PublishError::Refused);
        }
        self.channel.push(now, message);
        Ok(())
    }
}

/// Receives from one topic in memory.
#[derive(Debug)]
pub struct MemorySubscriber<M: Message> {
    channel: Arc<Channel<M>>,
    /// Number of the message to be taken next, counted since the topic began.
    next: u64,
    depth: Depth,
    counts: SubscriberCounts,
}

impl<M: Message> MemorySubscriber<M> {
    /// The newest message published before `now` and not taken yet.
    pub fn newest(&mut self, now: Time) -> Option<Received<M>> {
        self.newest_to(now, |own| Received {
            message: *own.message,
            received: own.received,
            source: own.source,
        })
    }

    /// The same as `take` takes it from its place; the topic waits meanwhile.
    pub fn newest_to<R>(&mut self, now: Time, take: impl FnOnce(Received<&M>) -> R) -> Option<R> {
        let from = self.next;
        if self.channel.end() <= from {
            return None;
        }
        let mut ring = lock(&self.channel.ring);
        let mut number = ring.newest_before(now, from, u64::MAX)?;
        self.next = number + 1;
        loop {
            let (found, valid) = ring.get(number)?;
            if self.counts.takes(&found.message, valid) {
                return Some(take(received(found)));
            }
            number = ring.newest_before(now, from, number)?;
        }
    }

    /// The oldest message published before `now` and not taken yet.
    pub fn next(&mut self, now: Time) -> Option<Received<M>> {
        if self.channel.end() <= self.next {
            return None;
        }
        let mut ring = lock(&self.channel.ring);
        loop {
            let newest = ring.newest_before(now, self.next, u64::MAX)?;
            // Only `depth` messages wait: what is older was dropped.
            let kept = (newest + 1).saturating_sub(self.depth.places() as u64);
            let number = self.next.max(kept).max(ring.first());
            if matches!(self.depth, Depth::Queue(_)) {
                self.counts.overflowed += number - self.next;
            }
            self.next = number + 1;
            let (found, valid) = ring.get(number)?;
            if self.counts.takes(&found.message, valid) {
                return Some(Received {
                    message: found.message,
                    received: found.at,
                    source: 0,
                });
            }
        }
    }

    /// What was handed out, refused and dropped so far.
    pub fn counts(&self) -> &SubscriberCounts {
        &self.counts
    }
}

impl SubscriberCounts {
    /// Whether `message`, found `valid` or not, can be acted on; counted either way.
    fn takes<M: Message>(&mut self, message: &M, valid: bool) -> bool {
        let takes = valid || self.valid(message);
        self.delivered += u64::from(takes);
        takes
    }
}

fn received<M: Message>(found: &Published<M>) -> Received<&M> {
    Received {
        message: &found.message,
        received: found.at,
        source: 0,
    }
}

/// A poisoned lock only says that another thread panicked between two
/// plain copies; what it guards is whole.
fn lock<T: ?Sized>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests;
