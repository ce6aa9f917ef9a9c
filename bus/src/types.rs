//! What the ways across have in common.

use ferntast_msgs::{Message, Text, Time, cdr::DecodeError};

/// How many messages wait for a subscriber.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Depth {
    /// Only the newest.
    Newest,
    /// Up to that many (at least 1); past that the oldest is dropped and counted.
    Queue(usize),
}

impl Depth {
    /// The number of places.
    pub const fn places(self) -> usize {
        match self {
            Depth::Newest => 1,
            Depth::Queue(places) => places,
        }
    }
}

/// A message as it arrived.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Received<M> {
    /// The message; [`Message::check`] holds.
    pub message: M,
    /// When it arrived. Memory, shared memory and recordings: when it was
    /// published. DDS: system time of its arrival on this host. Zenoh: system
    /// time when it was taken out of the queue of arrivals.
    pub received: Time,
    /// Who sent it: hash of the sender's GUID on DDS and Zenoh, 0 for everything on this host.
    pub source: u64,
}

/// What became of the messages of one subscriber since it was created.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SubscriberCounts {
    /// Handed out.
    pub delivered: u64,
    /// Refused: bytes that are not this type.
    pub undecodable: u64,
    /// Refused: longer than allowed.
    pub too_large: u64,
    /// Refused: readable, but [`Message::check`] or [`Message::from_ros`] says no.
    pub invalid: u64,
    /// Dropped because the queue was full. With [`Depth::Newest`] a message
    /// that a newer one replaces is not counted.
    pub overflowed: u64,
    /// Why the last one was refused, for people.
    pub last_refusal: Text<96>,
}

impl SubscriberCounts {
    /// All that was refused.
    pub const fn refused(&self) -> u64 {
        self.undecodable + self.too_large + self.invalid
    }

    /// Counts `error` under its kind.
    pub fn count(&mut self, error: &DecodeError) {
        self.last_refusal = Text::display(error);
        match error {
            DecodeError::TooLarge { .. } => self.too_large += 1,
            DecodeError::Invalid(_) => self.invalid += 1,
            _ => self.undecodable += 1,
        }
    }

    /// Whether `message` can be acted on; counted when it cannot.
    pub(crate) fn valid<M: Message>(&mut self, message: &M) -> bool {
        match message.check() {
            Ok(()) => true,
            Err(error) => {
                self.count(&DecodeError::Invalid(error));
                false
            }
        }
    }
}

/// The sample type's name for people: `JointSample (sensor_msgs/msg/JointState)`.
pub(crate) fn type_name<M: Message>() -> String {
    use ferntast_msgs::RosMessage;
    let path = std::any::type_name::<M>();
    let name = path.rsplit("::").next().unwrap_or(path);
    format!("{name} ({})", M::Ros::INTERFACE)
}
