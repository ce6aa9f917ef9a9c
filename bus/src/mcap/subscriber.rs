//! Subscribing to a recording.

use std::{collections::VecDeque, marker::PhantomData, sync::Arc};

use ferntast_bag::{RawMessage, RawMessages, SelectTopicError};
use ferntast_msgs::{
    Message, Text, Time, cdr,
    topics::{Delivery, Topic},
};

use super::shared::Reading;
use crate::types::{Depth, Received, SubscriberCounts};

/// Receives from one topic of a recording.
#[derive(Debug)]
pub struct McapSubscriber<M: Message> {
    reading: Arc<Reading>,
    messages: RawMessages,
    /// Visible and not taken, the oldest first.
    waiting: VecDeque<RawMessage>,
    depth: Depth,
    counts: SubscriberCounts,
    message: PhantomData<fn() -> M>,
}

impl<M: Message> McapSubscriber<M> {
    pub(super) fn new(
        reading: Arc<Reading>,
        topic: Topic<M>,
        depth: Depth,
    ) -> Result<McapSubscriber<M>, SelectTopicError> {
        let joined = reading.now();
        let from = match topic.delivery {
            Delivery::State => Time::from_nanos(0),
            Delivery::Stream | Delivery::Event => joined,
        };
        let messages = reading.reader.typed_raw::<M>(&topic.name, from)?;
        let mut subscriber = McapSubscriber {
            reading,
            messages,
            waiting: VecDeque::new(),
            depth,
            counts: SubscriberCounts::default(),
            message: PhantomData,
        };
        // Of a state, the last message before.
        subscriber.pull(joined, 1, false);
        Ok(subscriber)
    }

    /// The newest message published before `now` and not taken yet.
    pub fn newest(&mut self, now: Time) -> Option<Received<M>> {
        self.reading.advance(now);
        self.pull(now, self.depth.places(), false);
        let mut newest = None;
        while let (None, Some(raw)) = (&newest, self.waiting.pop_back()) {
            newest = self.admit(&raw);
        }
        self.waiting.clear();
        newest
    }

    /// The oldest message published before `now` and not taken yet.
    pub fn next(&mut self, now: Time) -> Option<Received<M>> {
        self.reading.advance(now);
        self.pull(
            now,
            self.depth.places(),
            matches!(self.depth, Depth::Queue(_)),
        );
        while let Some(oldest) = self.waiting.pop_front() {
            if let Some(received) = self.admit(&oldest) {
                return Some(received);
            }
        }
        None
    }

    /// What was handed out, refused and dropped so far. A part of the
    /// recording that is damaged counts as one undecodable message.
    pub fn counts(&self) -> &SubscriberCounts {
        &self.counts
    }

    /// Lets the messages published before `now` wait, the last `places` of them.
    fn pull(&mut self, now: Time, places: usize, counting: bool) {
        loop {
            match self.messages.next_before(now) {
                Ok(Some(message)) => self.waiting.push_back(message),
                Ok(None) => break,
                Err(error) => {
                    self.counts.undecodable += 1;
                    self.counts.last_refusal = Text::display(error);
                }
            }
            if self.waiting.len() > places {
                self.waiting.pop_front();
                self.counts.overflowed += u64::from(counting);
            }
        }
    }

    fn admit(&mut self, raw: &RawMessage) -> Option<Received<M>> {
        match cdr::decode_sample(raw.bytes()) {
            Ok(message) => {
                self.counts.delivered += 1;
                Some(Received {
                    message,
                    received: raw.log_time,
                    source: 0,
                })
            }
            Err(error) => {
                self.counts.count(&error);
                None
            }
        }
    }
}
