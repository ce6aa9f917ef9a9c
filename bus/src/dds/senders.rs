//! Whether a sender's type is the topic's.
//!
//! RustDDS joins writers and readers by the topic's name alone. Two types of
//! the same layout would pass for one another, so what a writer announced is
//! looked up when its first message comes.

use std::collections::HashMap;

use ros2_client::{Gid, dds::rustdds::DomainParticipant};

/// How many senders are remembered before they are looked up again.
const REMEMBERED: usize = 256;

/// What is known of the senders of one topic.
pub(super) struct Senders {
    participant: DomainParticipant,
    type_name: String,
    is_right: HashMap<Gid, bool>,
}

impl Senders {
    /// Of a topic of that DDS type name.
    pub(super) fn new(participant: DomainParticipant, type_name: String) -> Senders {
        Senders {
            participant,
            type_name,
            is_right: HashMap::new(),
        }
    }

    /// Whether `sender` announced the topic's type. One that is not known (it
    /// has gone, or is of this participant) gets the benefit of the doubt: its
    /// messages are decoded and checked like all others.
    pub(super) fn is_right(&mut self, sender: Gid) -> bool {
        if let Some(&is_right) = self.is_right.get(&sender) {
            return is_right;
        }
        let announced = self
            .participant
            .discovered_writers()
            .into_iter()
            .find(|writer| Gid::from(writer.publication_topic_data.key) == sender)
            .map(|writer| writer.publication_topic_data.type_name);
        let is_right = announced.is_none_or(|name| name == self.type_name);
        if self.is_right.len() == REMEMBERED {
            self.is_right.clear();
        }
        self.is_right.insert(sender, is_right);
        is_right
    }
}
