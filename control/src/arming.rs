//! The operator's word to arm again, as a count in every frame: it survives loss,
//! unlike an event.
//!
//! Zero says that the sender has heard no word since it was started; words count
//! 1 … 15 and then 1 again. So a sender that was started anew, whose count falls
//! back to zero, is no word. A watch begins anew with each process at the other end,
//! and after a gap: the first count that it sees is no word.

use crate::planted::{Planted, Rule};

/// Words of the operator to arm again, counted by the sender.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ArmingCount(u8);

impl ArmingCount {
    /// The largest count: a frame has four bits for it.
    pub const MAX: u8 = 15;

    /// As in a frame.
    pub fn get(self) -> u8 {
        self.0
    }

    /// The operator said it once more.
    pub fn add(&mut self) {
        self.0 = self.0 % Self::MAX + 1;
    }
}

/// Tells when the operator said so, from the count in each frame. Loss,
/// repetition, a restart of this end and one of the sender are no word.
#[derive(Clone, Copy, Debug, Default)]
pub struct ArmingWatch {
    last: Option<u8>,
    planted: Planted,
}

impl ArmingWatch {
    /// The same with a planted bug.
    pub fn planted(self, planted: Planted) -> ArmingWatch {
        ArmingWatch { planted, ..self }
    }

    /// Another process is at the other end, or frames cease to flow: the first count that
    /// is seen then is no word.
    pub fn restart(&mut self) {
        if !self.planted.lacks(Rule::RestartIsNoWord) {
            self.last = None;
        }
    }

    /// Whether `count` of the newest frame is a word that the one before did not have.
    ///
    /// After a sender's restart only its first word counts: a larger count would be
    /// left over from before the restart. Where the frames with the first word are
    /// all lost the operator has to say it again.
    pub fn observe(&mut self, count: u8) -> bool {
        let word = match self.last {
            None => false,
            Some(last) if self.planted.lacks(Rule::RestartIsNoWord) => count != last,
            Some(0) => count == 1,
            Some(last) => count != last && count != 0,
        };
        self.last = Some(count);
        word
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn words(counts: &[u8]) -> usize {
        let mut watch = ArmingWatch::default();
        counts.iter().filter(|count| watch.observe(**count)).count()
    }

    #[test]
    fn a_word_is_heard_once() {
        assert_eq!(words(&[0, 0, 1, 1, 1]), 1);
        assert_eq!(words(&[5, 5, 6, 6]), 1);
        assert_eq!(words(&[15, 15, 1, 1]), 1);
    }

    #[test]
    fn a_restart_of_either_end_is_no_word() {
        // Of this end: the first count that it sees.
        assert_eq!(words(&[7, 7, 7]), 0);
        // Of the sender, and then its first word.
        assert_eq!(words(&[3, 3, 0, 0, 0]), 0);
        assert_eq!(words(&[3, 3, 0, 0, 1, 1]), 1);
        // A frame from before the restart comes late.
        assert_eq!(words(&[3, 0, 3, 0]), 0);
    }

    proptest! {
        #[test]
        fn every_word_is_heard_where_no_frame_is_lost(said in 0..100usize) {
            let mut count = ArmingCount::default();
            let mut watch = ArmingWatch::default();
            watch.observe(count.get());
            for _ in 0..said {
                count.add();
                prop_assert!(watch.observe(count.get()));
                prop_assert!(!watch.observe(count.get()));
            }
        }

        #[test]
        fn no_word_is_heard_that_was_not_said(
            said in 0..40usize,
            restart in 0..40usize,
            lost in proptest::collection::vec(any::<bool>(), 80),
        ) {
            let mut count = ArmingCount::default();
            let mut watch = ArmingWatch::default();
            let mut heard = 0;
            for (step, lost) in lost.into_iter().enumerate() {
                if step == restart {
                    count = ArmingCount::default();
                }
                if step < said {
                    count.add();
                }
                if !lost {
                    heard += usize::from(watch.observe(count.get()));
                }
            }
            prop_assert!(heard <= said, "{heard} of {said}");
        }
    }
}
