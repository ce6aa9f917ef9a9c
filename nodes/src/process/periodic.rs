//! The time-triggered loop of a process.

use std::sync::atomic::{AtomicBool, Ordering};

use ferntast_msgs::Time;

use super::Clock;

/// When a step began.
#[derive(Clone, Copy, Debug)]
pub struct Wake {
    /// Now.
    pub now: Time,
    /// How late it is \[ns\].
    pub late_nanos: i64,
    /// Periods that were skipped before it.
    pub missed: u64,
}

/// Calls `tick` every `period_nanos` until `stop` is
/// set. Late steps are not caught up: whole periods that passed are counted as
/// missed and skipped.
pub fn run(clock: Clock, period_nanos: i64, stop: &AtomicBool, tick: impl FnMut(Wake)) {
    run_while(clock, period_nanos, || !stop.load(Ordering::Relaxed), tick);
}

/// As [`run`], for as long as `go_on` says so.
pub fn run_while(
    clock: Clock,
    period_nanos: i64,
    go_on: impl Fn() -> bool,
    mut tick: impl FnMut(Wake),
) {
    let mut due = clock.now().plus_nanos(period_nanos);
    while go_on() {
        clock.sleep_until(due);
        if !go_on() {
            break;
        }
        let now = clock.now();
        let late = now.nanos_since(due);
        if late < 0 {
            continue; // a signal woke us
        }
        let missed = late / period_nanos;
        tick(Wake {
            now,
            late_nanos: late,
            missed: missed as u64,
        });
        due = due.plus_nanos((missed + 1) * period_nanos);
    }
}
