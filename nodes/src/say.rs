//! From the laws' words to the messages'.

use std::fmt::{self, Write};

use ferntast_control::operating;
use ferntast_msgs::{
    Text, Time,
    sample::{OperatingState, OperatingStateSample, StateCommand},
};

/// How often a state is published though it did not change \[ns\].
const PERIOD_NANOS: i64 = 100_000_000;

/// `value` as a text of fixed size, without allocating.
pub fn say(value: &dyn fmt::Display) -> Text<96> {
    struct Line {
        bytes: [u8; 96],
        length: usize,
    }
    impl Write for Line {
        fn write_str(&mut self, text: &str) -> fmt::Result {
            for character in text.chars() {
                let end = self.length + character.len_utf8();
                if end > self.bytes.len() {
                    return Err(fmt::Error);
                }
                character.encode_utf8(&mut self.bytes[self.length..end]);
                self.length = end;
            }
            Ok(())
        }
    }
    let mut line = Line {
        bytes: [0; 96],
        length: 0,
    };
    // An error says that the text was cut, which is meant.
    let _ = write!(line, "{value}");
    Text::new(std::str::from_utf8(&line.bytes[..line.length]).unwrap_or(""))
}

/// A state command as the laws know it.
pub fn law_command(command: StateCommand) -> Option<operating::StateCommand> {
    operating::StateCommand::from_name(command.name()?)
}

/// Publishes an operating state when it changes, and every 0.1 s.
#[derive(Debug, Default)]
pub struct StatePublisher {
    last: Option<(operating::OperatingState, operating::Reason, bool)>,
    due: Time,
}

impl StatePublisher {
    /// The sample, when one is due.
    pub fn publish(
        &mut self,
        now: Time,
        state: operating::OperatingState,
        reason: operating::Reason,
        busy: bool,
    ) -> Option<OperatingStateSample> {
        if self.last == Some((state, reason, busy)) && now < self.due {
            return None;
        }
        self.last = Some((state, reason, busy));
        self.due = now.plus_nanos(PERIOD_NANOS);
        Some(OperatingStateSample {
            is_homed: 1,
            is_busy: u8::from(busy),
            ..OperatingStateSample::new(now, OperatingState(state.code()), say(&reason).as_str())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_text_is_cut_at_a_character() {
        let text = "é".repeat(60);
        assert_eq!(say(&text).as_str(), "é".repeat(48));
        assert_eq!(say(&"short").as_str(), "short");
    }

    #[test]
    fn a_state_is_published_when_it_changes_and_now_and_then() {
        let mut publisher = StatePublisher::default();
        let start = Time::from_nanos(1_000_000_000_000);
        let mut published = 0;
        for tick in 0..1000 {
            let state = if tick < 550 {
                operating::OperatingState::Disabled
            } else {
                operating::OperatingState::Enabled
            };
            let now = start.plus_nanos(tick * 1_000_000);
            let sample = publisher.publish(now, state, operating::Reason::Started, false);
            published += u32::from(sample.is_some());
            if tick == 550 {
                assert_eq!(sample.map(|own| own.state), Some(OperatingState::ENABLED));
            }
        }
        assert_eq!(published, 6 + 5);
    }
}
