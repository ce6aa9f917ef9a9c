//! Time in which the servo itself did not run.

use crate::nanoseconds;
use crate::planted::{Planted, Rule};

/// A step that comes later than this after the one before was held up \[s\].
const LATE: f64 = 0.002;
/// For so long after it was held up, the servo is patient with others \[s\]:
/// they were held up as well, and are about to be heard again.
const RECOVERY: f64 = 0.005;

/// Notes when the servo itself was held up, as a computer without a real-time
/// kernel holds up all its processes now and then. What fell silent only in
/// that time did not fall silent.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Stall {
    last_ns: Option<i64>,
    length_ns: i64,
    ended_ns: i64,
    just_ended: bool,
    pub(super) planted: Planted,
}

impl Stall {
    /// Notes a step at `now_ns` \[ns\]; gives the time by which others may be
    /// late on account of it \[ns\], zero as a rule.
    pub(super) fn step(&mut self, now_ns: i64) -> i64 {
        let since_ns = self.last_ns.map_or(0, |last| now_ns.saturating_sub(last));
        self.last_ns = Some(now_ns);
        // A clock that goes back hides how long it was.
        self.just_ended = since_ns.saturating_abs() > nanoseconds(LATE);
        if self.just_ended {
            self.length_ns = since_ns;
            self.ended_ns = now_ns;
        }
        let patient = now_ns.saturating_sub(self.ended_ns) <= nanoseconds(RECOVERY);
        if patient || self.planted.lacks(Rule::PatienceEnds) {
            self.length_ns.max(0)
        } else {
            0
        }
    }

    /// Whether the step is the first after it was held up for longer than `length` \[s\],
    /// or after its clock jumped so far.
    pub fn has_just_ended(&self, length: f64) -> bool {
        self.just_ended && self.length_ns.saturating_abs() > nanoseconds(length)
    }
}

#[cfg(test)]
mod tests {
    use super::super::TORQUE_LIFE;
    use super::*;

    const MS: i64 = 1_000_000;

    #[test]
    fn patience_lasts_as_long_as_the_recovery() {
        let mut stall = Stall::default();
        let start = 1_700_000_000_000 * MS;
        for tick in 0..100 {
            assert_eq!(stall.step(start + tick * MS), 0);
            assert!(!stall.has_just_ended(TORQUE_LIFE));
        }
        // Held up for 40 ms.
        let after = start + 139 * MS;
        for tick in 0..=5 {
            assert_eq!(stall.step(after + tick * MS), 40 * MS);
            assert_eq!(stall.has_just_ended(TORQUE_LIFE), tick == 0);
            assert!(!stall.has_just_ended(0.04));
        }
        assert_eq!(stall.step(after + 6 * MS), 0);
    }
}
