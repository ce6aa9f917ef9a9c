//! Real-time priority and wake-ups, on threads of their own.

use std::io;

use ferntast_msgs::Time;

use ferntast_nodes::process::Clock;

use super::super::host::WakeUps;

/// Asks for SCHED_FIFO on a thread that then ends.
pub(super) fn try_real_time_priority(priority: i32) -> io::Result<()> {
    on_a_thread(move || set_real_time_priority(priority))
}

/// How late each wake-up of such a loop was \[ns\].
pub(super) fn wake_up_lateness(wake_ups: WakeUps) -> io::Result<Vec<i64>> {
    on_a_thread(move || {
        if let Some(priority) = wake_ups.priority {
            set_real_time_priority(priority)?;
        }
        let period = i64::try_from(wake_ups.period.as_nanos());
        let period = period.map_err(io::Error::other)?.max(1);
        let mut lateness = Vec::with_capacity(wake_ups.count);
        let clock = Clock::start();
        let mut due = clock.now();
        for _ in 0..wake_ups.count {
            due = due.plus_nanos(period);
            let late = sleep_until(clock, due);
            lateness.push(late);
            // As the nodes do: periods that passed are not caught up.
            due = due.plus_nanos(late / period * period);
        }
        Ok(lateness)
    })
}

fn on_a_thread<T: Send + 'static>(
    work: impl FnOnce() -> io::Result<T> + Send + 'static,
) -> io::Result<T> {
    let thread = std::thread::Builder::new()
        .name("doctor".to_owned())
        .spawn(work)?;
    thread
        .join()
        .unwrap_or_else(|_| Err(io::Error::other("the measuring thread died")))
}

fn set_real_time_priority(priority: i32) -> io::Result<()> {
    // SAFETY: an all-zero sched_param is a valid value.
    let mut parameters: libc::sched_param = unsafe { std::mem::zeroed() };
    parameters.sched_priority = priority;
    // SAFETY: `parameters` is valid; 0 means the calling thread.
    if unsafe { libc::sched_setscheduler(0, libc::SCHED_FIFO, &parameters) } != 0 {
        return Err(io::Error::last_os_error());
    }
    Ok(())
}

/// Returns how late it woke \[ns\], never negative.
fn sleep_until(clock: Clock, due: Time) -> i64 {
    loop {
        clock.sleep_until(due);
        let late = clock.now().nanos_since(due);
        if late >= 0 {
            return late;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn every_wake_up_is_measured_and_none_is_early() {
        let lateness = wake_up_lateness(WakeUps {
            period: Duration::from_micros(500),
            count: 20,
            priority: None,
        })
        .expect("a normal thread needs no permission");
        assert_eq!(lateness.len(), 20);
        assert!(lateness.iter().all(|late| *late >= 0), "{lateness:?}");
    }

    #[test]
    fn a_priority_that_does_not_exist_is_an_error() {
        assert!(try_real_time_priority(1000).is_err());
    }
}
