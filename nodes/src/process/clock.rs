//! The one place that reads clocks.

use ferntast_msgs::Time;

/// UNIX time that advances with the monotonic clock: it never jumps. All
/// processes of a session share one offset, so that their stamps compare.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    offset_nanos: i64,
}

impl Clock {
    /// A clock that agrees with the system's wall clock now.
    pub fn start() -> Clock {
        Clock {
            offset_nanos: read(libc::CLOCK_REALTIME) - read(libc::CLOCK_MONOTONIC),
        }
    }

    /// The clock of a session that another process started.
    pub fn with_offset(offset_nanos: i64) -> Clock {
        Clock { offset_nanos }
    }

    /// UNIX time minus monotonic time \[ns\].
    pub fn offset_nanos(self) -> i64 {
        self.offset_nanos
    }

    /// The time now.
    pub fn now(self) -> Time {
        Time::from_nanos(read(libc::CLOCK_MONOTONIC) + self.offset_nanos)
    }

    /// Sleeps until `time`; returns early on a signal.
    pub fn sleep_until(self, time: Time) {
        let monotonic = time.nanos() - self.offset_nanos;
        let until = libc::timespec {
            tv_sec: monotonic.div_euclid(1_000_000_000),
            tv_nsec: monotonic.rem_euclid(1_000_000_000),
        };
        // SAFETY: `until` is a valid timespec; no remaining time is asked for.
        unsafe {
            libc::clock_nanosleep(
                libc::CLOCK_MONOTONIC,
                libc::TIMER_ABSTIME,
                &until,
                std::ptr::null_mut(),
            );
        }
    }
}

fn read(clock: libc::clockid_t) -> i64 {
    let mut time = libc::timespec {
        tv_sec: 0,
        tv_nsec: 0,
    };
    // SAFETY: `time` is valid for writing; both clocks exist on every Linux.
    unsafe {
        libc::clock_gettime(clock, &mut time);
    }
    time.tv_sec * 1_000_000_000 + time.tv_nsec
}
