//! A host's clock.

use ferntast_msgs::Time;

/// Nanoseconds of a step of virtual time.
const STEP_NANOS: i64 = 1_000_000;

/// The clock of a host: true time, and how far the host is from it.
#[derive(Clone, Copy, Debug)]
pub struct HostClock {
    start: Time,
    offset_nanos: i64,
    /// Nanoseconds gained in a step.
    drift_nanos: f64,
    /// When the drift began \[steps\].
    since: i64,
}

impl HostClock {
    /// A clock that is right.
    pub fn right(start: Time) -> HostClock {
        HostClock {
            start,
            offset_nanos: 0,
            drift_nanos: 0.0,
            since: 0,
        }
    }

    /// What it shows at `tick` \[steps since the start\].
    pub fn now(&self, tick: i64) -> Time {
        let drifted = (self.drift_nanos * (tick - self.since) as f64).round() as i64;
        self.start
            .plus_nanos(tick * STEP_NANOS + drifted + self.offset_nanos)
    }

    /// From `tick` on it is elsewhere by `offset_nanos` \[ns\] and goes wrong by `ppm`.
    pub fn set(&mut self, tick: i64, offset_nanos: i64, ppm: f64) {
        self.since = tick;
        self.offset_nanos = offset_nanos;
        self.drift_nanos = ppm * 1e-6 * STEP_NANOS as f64;
    }

    /// It jumps by `nanos` \[ns\].
    pub fn jump(&mut self, nanos: i64) {
        self.offset_nanos += nanos;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drift_adds_up_and_jumps_stay() {
        let start = Time::from_nanos(1_000_000_000_000);
        let mut clock = HostClock::right(start);
        assert_eq!(clock.now(10).nanos_since(start), 10_000_000);
        clock.set(0, -5_000, 100.0);
        // 100 ppm of a second are 100 µs.
        assert_eq!(clock.now(1000).nanos_since(start), 1_000_095_000);
        clock.jump(7_000_000);
        assert_eq!(clock.now(1000).nanos_since(start), 1_007_095_000);
    }
}
