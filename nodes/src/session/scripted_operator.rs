//! What the operator does whose hand is a script: goes on after a hold, as a person at the
//! master would who sees that nothing but silence stopped the arm.
//!
//! Pure. It gives the words that `ferntast state` gives, one after the other, each after a
//! person's time to react. It leaves the arm alone for good once somebody else stopped it or
//! took the master, and once a node died: what that means is for a person to judge.

use ferntast_control::operating::{Event, Reason};
use ferntast_msgs::{
    Time,
    sample::{OperatingState, OperatingStateSample, StateCommand},
};

use crate::node::is_because;

/// For so long all has to be well again before a word is given \[s\].
const REACTION: f64 = 1.0;

/// What the operator sees.
#[derive(Clone, Copy, Debug, Default)]
pub struct Seen {
    /// The arm's last word.
    pub arm: Option<OperatingStateSample>,
    /// All nodes are alive and the link is up.
    pub well: bool,
}

/// Whether nothing but silence stopped the arm.
pub fn is_silence(arm: &OperatingStateSample) -> bool {
    let because = |event| is_because(arm, Reason::Event(event));
    match arm.state {
        OperatingState::PAUSED => because(Event::CommandSilent),
        OperatingState::FAULT => because(Event::MeasurementSilent),
        _ => false,
    }
}

/// The operator of a script.
#[derive(Debug, Default)]
pub struct ScriptedOperator {
    /// It leaves the arm alone for good.
    hands_off: bool,
    /// The state that is to be left, and since when it could be.
    since: Option<(OperatingState, Time)>,
    /// It gave the word that took the drives off, to leave a fault.
    resetting: bool,
}

impl ScriptedOperator {
    /// Leaves the arm alone from now on; gives whether that is new.
    pub fn leave(&mut self) -> bool {
        !std::mem::replace(&mut self.hands_off, true)
    }

    /// The word that is due at `now`, if one is, and what it is an answer to.
    pub fn step(&mut self, now: Time, seen: &Seen) -> Option<(StateCommand, OperatingStateSample)> {
        let arm = seen.arm.filter(|_| !self.hands_off)?;
        let Some(word) = self.answer(&arm) else {
            self.since = None;
            self.resetting = false;
            return None;
        };
        let since = match self.since {
            Some((state, since)) if seen.well && state == arm.state => since,
            _ => {
                self.since = seen.well.then_some((arm.state, now));
                return None;
            }
        };
        if now.seconds_since(since) < REACTION {
            return None;
        }
        // What is not obeyed is said again after the same time.
        self.since = None;
        self.resetting = word == StateCommand::DISABLE || self.resetting;
        Some((word, arm))
    }

    /// What a person would say, who knows why the arm stands.
    fn answer(&self, arm: &OperatingStateSample) -> Option<StateCommand> {
        match arm.state {
            OperatingState::PAUSED if is_silence(arm) => Some(StateCommand::RESUME),
            OperatingState::FAULT if is_silence(arm) => Some(StateCommand::DISABLE),
            OperatingState::DISABLED if self.resetting => Some(StateCommand::ENABLE),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use ferntast_control::operating::StateCommand as Command;

    use super::*;

    fn at(seconds: f64) -> Time {
        Time::from_nanos(1_000_000_000_000 + (seconds * 1e9) as i64)
    }

    fn seen(state: OperatingState, reason: Reason) -> Seen {
        let reason = reason.to_string();
        Seen {
            arm: Some(OperatingStateSample::new(at(0.0), state, &reason)),
            well: true,
        }
    }

    /// The words of `seconds` in which the arm stays in that state.
    fn words(
        operator: &mut ScriptedOperator,
        from: f64,
        seconds: f64,
        seen: &Seen,
    ) -> Vec<StateCommand> {
        let rounds = 0..(seconds / 0.02) as i32;
        let steps =
            rounds.filter_map(|round| operator.step(at(from + f64::from(round) * 0.02), seen));
        steps.map(|(word, _)| word).collect()
    }

    const NONE: [StateCommand; 0] = [];
    const SILENT: Reason = Reason::Event(Event::CommandSilent);

    #[test]
    fn after_a_silence_it_goes_on_in_a_persons_time_and_says_so_again() {
        let mut operator = ScriptedOperator::default();
        let paused = seen(OperatingState::PAUSED, SILENT);
        assert_eq!(words(&mut operator, 0.0, 0.98, &paused), NONE);
        assert_eq!(words(&mut operator, 0.98, 1.5, &paused).len(), 2);
        let enabled = seen(OperatingState::ENABLED, Reason::Commanded(Command::Resume));
        assert_eq!(words(&mut operator, 3.0, 5.0, &enabled), NONE);
        // The time counts from the new pause.
        assert_eq!(words(&mut operator, 8.0, 0.98, &paused), NONE);
    }

    #[test]
    fn it_waits_until_all_is_well() {
        let mut operator = ScriptedOperator::default();
        let paused = seen(OperatingState::PAUSED, SILENT);
        let unwell = Seen {
            well: false,
            ..paused
        };
        assert_eq!(words(&mut operator, 0.0, 5.0, &unwell), NONE);
        assert_eq!(words(&mut operator, 5.0, 0.98, &paused), NONE);
        assert_eq!(
            words(&mut operator, 5.98, 0.1, &paused),
            [StateCommand::RESUME]
        );
    }

    #[test]
    fn a_fault_by_silence_is_left_by_two_words_and_other_faults_are_not() {
        let mut operator = ScriptedOperator::default();
        let silent = Reason::Event(Event::MeasurementSilent);
        let fault = seen(OperatingState::FAULT, silent);
        assert_eq!(
            words(&mut operator, 0.0, 1.1, &fault),
            [StateCommand::DISABLE]
        );
        let off = seen(
            OperatingState::DISABLED,
            Reason::Commanded(Command::Disable),
        );
        assert_eq!(words(&mut operator, 1.1, 1.1, &off), [StateCommand::ENABLE]);
        let enabled = seen(OperatingState::ENABLED, Reason::Commanded(Command::Enable));
        assert_eq!(words(&mut operator, 2.2, 0.1, &enabled), NONE);
        // What is off now, somebody else took off.
        assert_eq!(words(&mut operator, 2.3, 5.0, &off), NONE);
        for event in [
            Event::JointLimit(1),
            Event::Overspeed(2),
            Event::MeasurementJumped(1),
        ] {
            let fault = seen(OperatingState::FAULT, Reason::Event(event));
            assert_eq!(words(&mut operator, 9.0, 5.0, &fault), NONE, "{event:?}");
        }
    }

    #[test]
    fn a_stop_a_restarted_servo_and_hands_off_are_no_silence() {
        let mut operator = ScriptedOperator::default();
        for (state, reason) in [
            (OperatingState::PAUSED, Reason::Commanded(Command::Pause)),
            (
                OperatingState::DISABLED,
                Reason::Commanded(Command::Disable),
            ),
            (OperatingState::DISABLED, Reason::Started),
        ] {
            assert_eq!(words(&mut operator, 0.0, 9.0, &seen(state, reason)), NONE);
        }
        let paused = seen(OperatingState::PAUSED, SILENT);
        assert!(operator.leave());
        assert!(!operator.leave());
        assert_eq!(words(&mut operator, 9.0, 9.0, &paused), NONE);
    }
}
