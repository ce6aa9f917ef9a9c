//! What a step finds at its inputs.

use ferntast_msgs::{Message, Time};

/// The newest message of a topic, kept until a newer one arrives.
#[derive(Clone, Copy, Debug)]
pub struct Newest<M> {
    /// The message, once there was one.
    pub message: Option<M>,
    /// When it was received.
    pub received: Time,
    /// Whether it arrived since the last step.
    pub fresh: bool,
}

impl<M> Default for Newest<M> {
    fn default() -> Self {
        Newest {
            message: None,
            received: Time::INVALID,
            fresh: false,
        }
    }
}

impl<M: Message> Newest<M> {
    /// The message if it arrived since the last step.
    pub fn fresh(&self) -> Option<&M> {
        self.message.as_ref().filter(|_| self.fresh)
    }

    /// Seconds since the message was received \[s\]; infinite without one.
    pub fn silence(&self, now: Time) -> f64 {
        match self.message {
            Some(_) => now.seconds_since(self.received),
            None => f64::INFINITY,
        }
    }
}

/// How many messages of one topic a step takes at most.
pub const BATCH: usize = 16;

/// Every message of a topic that arrived since the last step, oldest first.
#[derive(Clone, Debug)]
pub struct Batch<M> {
    messages: [Option<M>; BATCH],
    length: usize,
}

impl<M: Copy> Default for Batch<M> {
    fn default() -> Self {
        Batch {
            messages: [None; BATCH],
            length: 0,
        }
    }
}

impl<M: Copy> Batch<M> {
    /// Empties the batch.
    pub fn clear(&mut self) {
        self.messages[..self.length].fill(None);
        self.length = 0;
    }

    /// Whether no further message fits.
    pub fn is_full(&self) -> bool {
        self.length == BATCH
    }

    /// Appends a message; one that does not fit is dropped.
    pub fn push(&mut self, message: M) {
        if let Some(place) = self.messages.get_mut(self.length) {
            *place = Some(message);
            self.length += 1;
        }
    }

    /// The messages, oldest first.
    pub fn iter(&self) -> impl Iterator<Item = &M> {
        self.messages[..self.length].iter().flatten()
    }
}
