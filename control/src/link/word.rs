//! The operator's word to arm, on its way through the arm's end of the link.
//!
//! The word comes as a count in frames, and takes its time. What was said before the
//! operator's end knew that the arm had stopped is no answer to that stop: a person
//! beside the arm may have said "pause" meanwhile. So a word counts only in a frame that
//! echoes a frame of this end which was sent after the arm stopped last, by whatever
//! clock: both times are of this end's. And this end counts its stops in its own frames,
//! so that the operator's end forgets what was said before one of them and has not got
//! through yet.

use crate::arming::{ArmingCount, ArmingWatch};
use crate::frame::LinkFrame;
use crate::operating::OperatingState;
use crate::planted::Planted;

/// A word to arm and a stop that is told to the arm this soon after may cross on their way
/// to the servo: the stop is said once more \[ns\].
const CROSSING_NS: i64 = 5_000_000;
/// Times in frames are rounded to this \[ns\].
const ROUNDING_NS: i64 = 8;

/// What to tell the arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Word {
    /// The operator says to arm.
    Rearm,
    /// The operator said so before it was known there that the arm had stopped: nothing
    /// to tell the arm, but the operator.
    Outdated,
    /// A stop that crossed a word to arm.
    Stop,
}

/// Passes on the operator's words.
#[derive(Clone, Copy, Debug)]
pub(super) struct WordWatch {
    arming: ArmingWatch,
    stops: ArmingCount,
    stopped_ns: Option<i64>,
    passed_on_ns: Option<i64>,
    state: OperatingState,
}

impl Default for WordWatch {
    fn default() -> Self {
        WordWatch {
            arming: ArmingWatch::default(),
            stops: ArmingCount::default(),
            stopped_ns: None,
            passed_on_ns: None,
            state: OperatingState::Disabled,
        }
    }
}

impl WordWatch {
    /// The same with a planted bug.
    pub fn planted(self, planted: Planted) -> WordWatch {
        WordWatch {
            arming: self.arming.planted(planted),
            ..self
        }
    }

    /// Another process is at the other end, or frames cease to flow.
    pub fn restart(&mut self) {
        self.arming.restart();
    }

    /// Stops of the arm, counted.
    pub fn stops(&self) -> u8 {
        self.stops.get()
    }

    /// One step at `now_ns`: the arm is in `state`, was `told_to_stop` since the step
    /// before, and `taken` is a new frame of the operator's end.
    pub fn step(
        &mut self,
        now_ns: i64,
        state: OperatingState,
        told_to_stop: bool,
        taken: Option<&LinkFrame>,
    ) -> Option<Word> {
        let was_enabled = self.state == OperatingState::Enabled;
        self.state = state;
        if told_to_stop || (was_enabled && state != OperatingState::Enabled) {
            self.stops.add();
            self.stopped_ns = Some(now_ns);
        }
        // A clock that goes back takes the stop with it.
        self.stopped_ns = self.stopped_ns.map(|stopped_ns| stopped_ns.min(now_ns));
        let heard = taken.filter(|frame| self.arming.observe(frame.arming));
        let crossed = self.passed_on_ns.is_some_and(|passed_on_ns| {
            now_ns.saturating_sub(passed_on_ns).saturating_abs() <= CROSSING_NS
        });
        if told_to_stop && crossed {
            self.passed_on_ns = None;
            return Some(Word::Stop);
        }
        let known = match (self.stopped_ns, heard?.echo) {
            (None, _) => true,
            (Some(_), None) => false,
            (Some(stopped_ns), Some(echo)) => {
                echo.sent_ns.saturating_add(ROUNDING_NS) >= stopped_ns
            }
        };
        if !known {
            return Some(Word::Outdated);
        }
        self.passed_on_ns = Some(now_ns);
        Some(Word::Rearm)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::Packet;
    use crate::frame::Echo;
    use OperatingState::{Enabled, Paused};

    const START_NS: i64 = 1_700_000_000_000_000_000;
    const MS: i64 = 1_000_000;

    /// A frame with a count, which echoes what this end sent at `known_ms`.
    fn frame(arming: u8, known_ms: Option<i64>) -> LinkFrame {
        LinkFrame {
            sequence: 0,
            stamp_ns: START_NS,
            sent_ns: START_NS,
            echo: known_ms.map(|ms| Echo {
                sent_ns: START_NS + ms * MS,
                held_ns: 0,
            }),
            hold: false,
            state: Enabled,
            arming,
            law: 0,
            pace: 0,
            since_content: 0,
            packet: Packet::default(),
            orientation: None,
        }
    }

    struct Arm {
        words: WordWatch,
    }

    impl Arm {
        fn at(&mut self, ms: i64, state: OperatingState, frame: Option<LinkFrame>) -> Option<Word> {
            let now_ns = START_NS + ms * MS;
            self.words.step(now_ns, state, false, frame.as_ref())
        }

        fn stop(&mut self, ms: i64, state: OperatingState) -> Option<Word> {
            self.words.step(START_NS + ms * MS, state, true, None)
        }
    }

    fn arm() -> Arm {
        let mut arm = Arm {
            words: WordWatch::default(),
        };
        arm.at(0, Paused, Some(frame(0, None)));
        arm
    }

    #[test]
    fn a_word_counts_where_the_stop_was_known() {
        let mut arm = arm();
        // Nothing to know of.
        assert_eq!(arm.at(2, Paused, Some(frame(1, None))), Some(Word::Rearm));
        assert_eq!(arm.at(4, Enabled, Some(frame(1, None))), None);
        // It stops at 100, and the next word knows of 90, the one after of 100.
        assert_eq!(arm.at(100, Paused, None), None);
        let early = frame(2, Some(90));
        assert_eq!(arm.at(110, Paused, Some(early)), Some(Word::Outdated));
        assert_eq!(arm.at(112, Paused, Some(frame(2, Some(102)))), None);
        let later = frame(3, Some(100));
        assert_eq!(arm.at(114, Paused, Some(later)), Some(Word::Rearm));
    }

    #[test]
    fn a_stop_of_a_paused_arm_is_a_stop() {
        let mut arm = arm();
        assert_eq!(arm.stop(10, Paused), None);
        let early = frame(1, Some(9));
        assert_eq!(arm.at(12, Paused, Some(early)), Some(Word::Outdated));
        assert_eq!(arm.words.stops(), 1);
        // After the clock went back the next word counts.
        assert_eq!(arm.at(-9000, Paused, None), None);
        let later = frame(2, Some(-8990));
        assert_eq!(arm.at(-8980, Paused, Some(later)), Some(Word::Rearm));
    }

    #[test]
    fn a_stop_that_crosses_a_word_is_said_again() {
        let mut arm = arm();
        assert_eq!(arm.at(2, Paused, Some(frame(1, None))), Some(Word::Rearm));
        assert_eq!(arm.stop(3, Paused), Some(Word::Stop));
        assert_eq!(arm.stop(4, Enabled), None);
        assert_eq!(arm.words.stops(), 2);
    }
}
