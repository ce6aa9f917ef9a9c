//! The time-triggered loop of a process.

use std::sync::atomic::{AtomicBool, Ordering};

use ferntast_msgs::Time;

use super::Clock;

/// Real-time priority (SCHED_FIFO) of the 1 kHz loops: below the kernel's own
/// interrupt threads at 50.
const PRIORITY: libc::c_int = 40;

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

/// Asks for real-time priority for the calling thread.
///
/// # Errors
///
/// The operating system's reason when it is refused. Work goes on without.
pub fn request_realtime() -> Result<(), std::io::Error> {
    let parameters = libc::sched_param {
        sched_priority: PRIORITY,
    };
    // SAFETY: `parameters` is valid; 0 means the calling thread.
    let result = unsafe { libc::sched_setscheduler(0, libc::SCHED_FIFO, &parameters) };
    if result == 0 {
        Ok(())
    } else {
        Err(std::io::Error::last_os_error())
    }
}
