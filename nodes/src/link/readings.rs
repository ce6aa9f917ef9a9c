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

/// The state of an end's device; disabled as long as it says nothing.
pub fn operating_state(state: &Newest<OperatingStateSample>) -> OperatingState {
    state
        .message
        .and_then(|sample| OperatingState::from_code(sample.state.0))
        .unwrap_or(OperatingState::Disabled)
}
