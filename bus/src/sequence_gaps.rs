//! Gaps in the numbers that each sender gives its messages.

use std::hash::{DefaultHasher, Hasher};

/// How many senders are distinguished; of fixed size, as it is on the control path.
const SENDERS: usize = 16;

/// The number that each sender's next message has.
#[derive(Debug, Default)]
pub(crate) struct SequenceGaps {
    next: Box<[Option<(u128, u64)>; SENDERS]>,
    /// Place given to the next new sender, once all are taken.
    oldest: usize,
}

impl SequenceGaps {
    /// How many messages of `sender` are missing before `number`. What a
    /// sender sent before its first message here is not missing.
    pub(crate) fn before(&mut self, sender: u128, number: u64) -> u64 {
        let next = number.saturating_add(1);
        let known = self
            .next
            .iter_mut()
            .flatten()
            .find(|(known, _)| *known == sender);
        if let Some((_, expected)) = known {
            let missing = number.saturating_sub(*expected);
            *expected = next;
            return missing;
        }
        let free = self.next.iter().position(Option::is_none);
        let place = free.unwrap_or_else(|| {
            let place = self.oldest;
            self.oldest = (place + 1) % SENDERS;
            place
        });
        self.next[place] = Some((sender, next));
        0
    }
}

/// A sender's GUID as a number that is never 0 (which stands for this host);
/// the same GUID gives the same number in every process of a session.
pub(crate) fn source(guid: &[u8]) -> u64 {
    let mut hasher = DefaultHasher::new();
    hasher.write(guid);
    hasher.finish().max(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_are_counted_for_each_sender_apart() {
        let mut gaps = SequenceGaps::default();
        assert_eq!(
            gaps.before(1, 5),
            0,
            "what came before the first is not missing"
        );
        assert_eq!(gaps.before(2, 0), 0);
        assert_eq!(gaps.before(1, 6), 0);
        assert_eq!(gaps.before(1, 10), 3);
        assert_eq!(gaps.before(2, 2), 1);
        assert_eq!(gaps.before(2, 1), 0, "out of order is no gap");
    }

    #[test]
    fn more_senders_than_places_never_panic() {
        let mut gaps = SequenceGaps::default();
        for sender in 0..100 {
            assert_eq!(gaps.before(sender, u64::MAX), 0);
        }
    }

    #[test]
    fn senders_have_numbers_of_their_own() {
        assert_eq!(source(b"a"), source(b"a"));
        assert_ne!(source(b"a"), source(b"b"));
        assert_ne!(source(&[]), 0);
    }
}
