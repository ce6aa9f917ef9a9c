//! States that a test publishes over DDS.

use std::{
    thread,
    time::{Duration, Instant},
};

use ferntast_bus::{PublishError, Publisher};
use ferntast_msgs::{
    Text, Time,
    sample::{OperatingState, OperatingStateSample},
};

/// How long a state may be refused, where it takes 0.1 s on a busy machine.
const PATIENCE: Duration = Duration::from_secs(10);

/// Publishes the `k`-th state. A burst that the loop of DDS has not taken yet is refused, and
/// tried again.
pub fn publish(
    publisher: &mut Publisher<OperatingStateSample>,
    k: i64,
) -> Result<(), PublishError> {
    let stamp = Time::from_nanos(1_000_000_000 + k);
    let state = OperatingStateSample {
        stamp,
        state: OperatingState::ENABLED,
        is_homed: 1,
        is_busy: 0,
        reserved: [0; 5],
        reason: Text::EMPTY,
    };
    let begin = Instant::now();
    loop {
        match publisher.publish(stamp, &state) {
            Err(_) if begin.elapsed() < PATIENCE => thread::sleep(Duration::from_millis(1)),
            told => return told,
        }
    }
}
