//! The messages of one topic, numbered from its beginning.

use std::collections::VecDeque;

use ferntast_msgs::{Message, Time};

/// Places beyond the longest queue, for messages published at times that the
/// readers have not come to yet (the present tick's, and some more for
/// readers whose time lags behind).
const AHEAD: usize = 64;

/// A message as it was published.
#[derive(Clone, Copy, Debug)]
pub(super) struct Published<M> {
    /// When.
    pub(super) at: Time,
    /// The message.
    pub(super) message: M,
    /// Whether it can be acted on, once somebody looked: looking takes longer than reading.
    valid: Option<bool>,
}

/// The last messages of one topic.
#[derive(Debug)]
pub(super) struct Ring<M> {
    messages: VecDeque<Published<M>>,
    places: usize,
    /// Number of the oldest message kept.
    first: u64,
}

impl<M: Copy> Ring<M> {
    pub(super) fn new() -> Ring<M> {
        let places = AHEAD + 1;
        Ring {
            messages: VecDeque::with_capacity(places),
            places,
            first: 0,
        }
    }

    /// Allocates a queue of that depth; the only place that allocates.
    pub(super) fn reserve(&mut self, depth: usize) {
        let places = AHEAD + depth;
        if places > self.places {
            self.messages.reserve_exact(places - self.messages.len());
            self.places = places;
        }
    }

    pub(super) fn push(&mut self, now: Time, message: &M) {
        if self.messages.len() == self.places {
            self.messages.pop_front();
            self.first += 1;
        }
        self.messages.push_back(Published {
            at: now,
            message: *message,
            valid: None,
        });
    }

    /// Number of the oldest message kept.
    pub(super) fn first(&self) -> u64 {
        self.first
    }

    /// Number that the next message will get.
    pub(super) fn end(&self) -> u64 {
        self.first + self.messages.len() as u64
    }

    /// Number of the last message, or of the next one when there is none yet.
    pub(super) fn last(&self) -> u64 {
        self.end().saturating_sub(1).max(self.first)
    }

    /// Number of the newest message published before `now`, among the numbers `from..end`.
    pub(super) fn newest_before(&self, now: Time, from: u64, end: u64) -> Option<u64> {
        // From the back: mostly the last or the one before it.
        let from = from.max(self.first);
        let mut number = self.end().min(end);
        while number > from {
            number -= 1;
            if self.messages.get(self.index(number)?)?.at < now {
                return Some(number);
            }
        }
        None
    }

    /// The message of that number, when it is kept, and whether it can be acted on: found
    /// once, whoever asks, and by what is known of the one before it.
    pub(super) fn get(&mut self, number: u64) -> Option<(&Published<M>, bool)>
    where
        M: Message,
    {
        let index = self.index(number)?;
        let found = self.messages.get(index)?;
        let valid = found.valid.unwrap_or_else(|| {
            let before = index.checked_sub(1).and_then(|own| self.messages.get(own));
            match before.filter(|own| own.valid == Some(true)) {
                Some(before) => found.message.check_after(&before.message).is_ok(),
                None => found.message.check().is_ok(),
            }
        });
        let found = self.messages.get_mut(index)?;
        found.valid = Some(valid);
        Some((found, valid))
    }

    fn index(&self, number: u64) -> Option<usize> {
        usize::try_from(number.checked_sub(self.first)?).ok()
    }
}
