//! Velocity from positions.

use super::StampedPosition;
use super::end::seconds_between;
use crate::delay::Motion;

/// Time constant of the low pass on the difference quotient \[s\].
const TIME_CONSTANT: f64 = 0.005;
/// After a gap longer than this \[s\] the filter starts again at rest.
const LONGEST_GAP: f64 = 0.050;

/// Filtered difference of stamped positions.
#[derive(Clone, Debug, Default)]
pub(super) struct VelocityFilter {
    last: Option<(i64, [f64; 3])>,
    velocity: [f64; 3],
}

impl VelocityFilter {
    /// Takes in the newest measurement, if there is one; gives its motion while it
    /// is not older than `life` \[s\].
    pub fn fresh(&mut self, measured: Option<StampedPosition>, life: f64) -> Option<Motion> {
        let measured = measured?;
        let motion = self.step(&measured);
        (measured.silence <= life).then_some(motion)
    }

    /// Position and velocity at the newest measurement; a repeated stamp changes nothing.
    fn step(&mut self, measured: &StampedPosition) -> Motion {
        if let Some((stamp_ns, position)) = self.last {
            let dt = seconds_between(stamp_ns, measured.stamp_ns);
            if !(0.0..=LONGEST_GAP).contains(&dt) {
                self.velocity = [0.0; 3];
            } else if dt > 0.0 {
                let share = dt / (dt + TIME_CONSTANT);
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
