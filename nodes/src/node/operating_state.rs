//! Operating states and state commands: from the messages' form to that of `control`, and back.

use ferntast_control::operating;
use ferntast_msgs::{
    Text, Time,
    sample::{OperatingState, OperatingStateSample, StateCommand},
};

/// How often a state is published though it did not change \[ns\].
const PERIOD_NANOS: i64 = 100_000_000;

/// A state command as `control` knows it; `None` for one that it does not have.
pub fn to_law(command: StateCommand) -> Option<operating::StateCommand> {
    operating::StateCommand::from_name(command.name()?)
}

/// Whether `told` says that its device is in its state for that reason.
pub fn is_because(told: &OperatingStateSample, reason: operating::Reason) -> bool {
    told.reason == Text::<96>::display(reason)
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
            ..OperatingStateSample::new(
                now,
                OperatingState(state.code()),
                Text::<96>::display(reason).as_str(),
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
