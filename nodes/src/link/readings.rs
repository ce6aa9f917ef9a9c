//! Messages as the ends take them.

use ferntast_control::{link::StampedPosition, operating::OperatingState};
use ferntast_msgs::{
    Time,
    sample::{OperatingStateSample, PoseSample},
};

use crate::node::Newest;

/// A pose as the ends take it.
pub fn position(now: Time, pose: &Newest<PoseSample>) -> Option<StampedPosition> {
    pose.message.map(|own| StampedPosition {
        stamp_ns: own.stamp.nanos(),
        position: own.position,
        silence: pose.silence(now),
    })
}

/// A device that has not said for so long what state it is in, is in none \[s\]: it says so ten
/// times a second.
const STATE_LIFE: f64 = 0.3;

/// The state of an end's device; disabled as long as it says nothing.
pub fn operating_state(now: Time, state: &Newest<OperatingStateSample>) -> OperatingState {
    state
        .message
        .filter(|_| state.silence(now) <= STATE_LIFE)
        .and_then(|sample| OperatingState::from_code(sample.state.0))
        .unwrap_or(OperatingState::Disabled)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A device that hangs may be believed for as long as it takes to say the next word three
    /// times over.
    #[test]
    fn a_device_that_says_nothing_any_more_is_in_no_state() {
        let said = Time::from_nanos(1_700_000_000_000_000_000);
        let code = ferntast_msgs::sample::OperatingState::ENABLED;
        let state = Newest {
            message: Some(OperatingStateSample::new(
                said,
                code,
                "enable was asked for",
            )),
            received: said,
            fresh: false,
        };
        let after = |seconds: f64| operating_state(said.plus_seconds(seconds), &state);
        assert_eq!(after(0.0), OperatingState::Enabled);
        assert_eq!(after(0.25), OperatingState::Enabled);
        assert_eq!(after(0.35), OperatingState::Disabled);
        assert_eq!(
            operating_state(said, &Newest::default()),
            OperatingState::Disabled
        );
    }
}
