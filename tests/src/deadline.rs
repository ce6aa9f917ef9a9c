//! Waiting, but never for ever.

use std::{
    thread,
    time::{Duration, Instant},
};

/// How often a condition is looked at.
const PERIOD: Duration = Duration::from_millis(10);

/// What a program may take that would end within `limit`: more, where all others go before it
/// (`./tests/run` runs so what computes), as it waits for these.
pub fn patience(limit: Duration) -> Duration {
    // SAFETY: no pointers; 0 is this thread.
    match unsafe { libc::sched_getscheduler(0) } {
        libc::SCHED_IDLE => 5 * limit,
        _ => limit,
    }
}

/// Whether `condition` came true within `limit`.
pub fn wait_until(limit: Duration, mut condition: impl FnMut() -> bool) -> bool {
    wait_for(limit, || condition().then_some(())).is_some()
}

/// The first value that `look` gives within `limit`.
pub fn wait_for<T>(limit: Duration, mut look: impl FnMut() -> Option<T>) -> Option<T> {
    let end = Instant::now() + limit;
    loop {
        if let Some(value) = look() {
            return Some(value);
        }
        if Instant::now() >= end {
            return None;
        }
        thread::sleep(PERIOD);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gives_up_at_the_deadline_and_not_before() {
        let start = Instant::now();
        assert!(!wait_until(Duration::from_millis(50), || false));
        assert!(start.elapsed() >= Duration::from_millis(50));
    }

    #[test]
    fn gives_the_value_as_soon_as_it_is_there() {
        let mut looks = 0;
        let value = wait_for(Duration::from_secs(60), || {
            looks += 1;
            (looks == 3).then_some(looks)
        });
        assert_eq!(value, Some(3));
    }
}
