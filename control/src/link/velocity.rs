//! Velocity from positions.

use super::StampedPosition;
use super::end::seconds_between;
use crate::delay::Motion;
use crate::low_pass_share;

/// Time constant of the low pass on the difference quotient \[s\].
const TIME_CONSTANT: f64 = 0.005;
/// After a gap longer than this \[s\] the filter starts again at rest.
const LONGEST_GAP: f64 = 0.050;

/// A hand is good for no less than this \[s\]: with a step on the way and the watchdog of the
/// arm's servo it is 30 ms from the last frame of a master that has died to the hold …
pub const SHORTEST_LIFE: f64 = 0.004;
/// … and no longer than this \[s\], however slowly it is measured.
pub const LONGEST_LIFE: f64 = 0.025;
/// For how many of its periods a hand is good: the next may be late by half of one.
const PERIODS: f64 = 1.5;
/// How many periods are looked at.
const REMEMBERED: usize = 8;

/// Filtered difference of stamped positions.
#[derive(Clone, Debug, Default)]
pub(super) struct VelocityFilter {
    last: Option<(i64, [f64; 3])>,
    velocity: [f64; 3],
    /// The last times between two measurements, in a ring \[s\].
    periods: [f64; REMEMBERED],
    next: usize,
}

impl VelocityFilter {
    /// Takes in the newest measurement, if there is one; gives its motion while it
    /// is not older than `life` \[s\].
    pub fn fresh(&mut self, measured: Option<StampedPosition>, life: f64) -> Option<Motion> {
        let measured = measured?;
        let motion = self.step(&measured);
        (measured.silence <= life).then_some(motion)
    }

    /// As [`fresh`](Self::fresh), good for as long as the rate of the measurements
    /// says: a hand at 100 Hz is there between two of them, one at 1 kHz that falls
    /// silent is not repeated for long, so that the arm's watchdog sees it.
    pub fn fresh_by_its_rate(&mut self, measured: Option<StampedPosition>) -> Option<Motion> {
        let measured = measured?;
        let mut motion = self.step(&measured);
        let life = self.life();
        if life > SHORTEST_LIFE {
            // It goes on moving between two measurements: in steps a law would feel each.
            let since = measured.silence.clamp(0.0, life);
            let axes = motion.position.iter_mut().zip(motion.velocity);
            axes.for_each(|(position, velocity)| *position += velocity * since);
        }
        (measured.silence <= life).then_some(motion)
    }

    /// How long a measurement is good \[s\]: by the middle one of its last periods, as one
    /// gap, of a host that was held up, is no period.
    fn life(&self) -> f64 {
        let mut periods = self.periods;
        let known = &mut periods[..self.next.min(REMEMBERED)];
        known.sort_unstable_by(f64::total_cmp);
        let middle = known.get(known.len() / 2).copied().unwrap_or(0.0);
        (PERIODS * middle).clamp(SHORTEST_LIFE, LONGEST_LIFE)
    }

    /// Position and velocity at the newest measurement; a repeated stamp changes nothing.
    fn step(&mut self, measured: &StampedPosition) -> Motion {
        if let Some((stamp_ns, position)) = self.last {
            let dt = seconds_between(stamp_ns, measured.stamp_ns);
            // What is longer was a silence, not a period.
            if dt > 0.0 && dt <= LONGEST_LIFE {
                self.periods[self.next % REMEMBERED] = dt;
                self.next = self.next.saturating_add(1);
            }
            if !(0.0..=LONGEST_GAP).contains(&dt) {
                self.velocity = [0.0; 3];
            } else if dt > 0.0 {
                let share = low_pass_share(dt, TIME_CONSTANT);
                let axes = self.velocity.iter_mut().zip(measured.position);
                for ((velocity, now), before) in axes.zip(position) {
                    *velocity += share * ((now - before) / dt - *velocity);
                }
            }
        }
        self.last = Some((measured.stamp_ns, measured.position));
        Motion {
            position: measured.position,
            velocity: self.velocity,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Milliseconds of silence until a hand of that period is no longer there.
    fn lives(period: i64) -> i64 {
        let mut filter = VelocityFilter::default();
        let at = |ms: i64, silence: f64| {
            Some(StampedPosition {
                stamp_ns: 1_000_000_000_000 + ms * 1_000_000,
                position: [0.0; 3],
                silence,
            })
        };
        for tick in 0..20 {
            filter.fresh_by_its_rate(at(period * tick, 0.0));
        }
        let last = period * 19;
        (0..100)
            .find(|ms| {
                filter
                    .fresh_by_its_rate(at(last, *ms as f64 * 1e-3))
                    .is_none()
            })
            .unwrap()
    }

    #[test]
    fn a_slow_hand_is_there_between_two_measurements_and_a_quick_one_is_missed_soon() {
        assert_eq!(lives(1), 5);
        assert_eq!(lives(2), 5);
        assert_eq!(lives(4), 7);
        assert_eq!(lives(10), 16);
        assert_eq!(lives(16), 25);
    }

    #[test]
    fn one_gap_of_a_host_that_was_held_up_is_no_period() {
        let mut filter = VelocityFilter::default();
        let mut at = |ms: i64, silence: f64| {
            filter.fresh_by_its_rate(Some(StampedPosition {
                stamp_ns: 1_000_000_000_000 + ms * 1_000_000,
                position: [1e-3 * ms as f64, 0.0, 0.0],
                silence,
            }))
        };
        for ms in 0..20 {
            at(ms, 0.0);
        }
        // Held up for 9 ms, heard once, and silent from then on: it is not good for 13 ms, nor
        // led on from where it was.
        let heard = at(29, 0.0).map(|own| own.position[0]);
        assert_eq!(heard, Some(0.029));
        assert_eq!(at(29, 0.004).map(|own| own.position[0]), Some(0.029));
        assert_eq!(at(29, 0.005), None);
    }

    #[test]
    fn a_steady_motion_has_its_velocity_and_a_gap_begins_anew() {
        let mut filter = VelocityFilter::default();
        let mut step = |milliseconds: i64, x: f64| {
            filter.step(&StampedPosition {
                stamp_ns: 1_000_000_000_000 + milliseconds * 1_000_000,
                position: [x, 0.0, 0.0],
                silence: 0.0,
            })
        };
        let mut motion = Motion::default();
        for tick in 0..100 {
            motion = step(tick, 0.2e-3 * tick as f64);
        }
        assert!((motion.velocity[0] - 0.2).abs() < 1e-6, "{motion:?}");
        assert_eq!(step(1000, 1.0).velocity, [0.0; 3]);
    }
}
