//! Velocity from positions.

use ferntast_control::delay::Motion;
use ferntast_msgs::{Time, sample::PoseSample};

/// Time constant of the low pass on the difference quotient \[s\].
const TIME_CONSTANT: f64 = 0.005;
/// A gap longer than this \[s\] begins anew at rest.
const LONGEST_GAP: f64 = 0.050;

/// Filtered difference of stamped positions.
#[derive(Debug, Default)]
pub struct VelocityFilter {
    last: Option<(Time, [f64; 3])>,
    velocity: [f64; 3],
}

impl VelocityFilter {
    /// Position and velocity at the newest pose; a repeated stamp changes nothing.
    pub fn step(&mut self, pose: &PoseSample) -> Motion {
        if let Some((stamp, position)) = self.last {
            let dt = pose.stamp.seconds_since(stamp);
            if !(0.0..=LONGEST_GAP).contains(&dt) {
                self.velocity = [0.0; 3];
            } else if dt > 0.0 {
                let share = dt / (dt + TIME_CONSTANT);
                let axes = self.velocity.iter_mut().zip(pose.position).zip(position);
                for ((velocity, now), before) in axes {
                    *velocity += share * ((now - before) / dt - *velocity);
                }
            }
        }
        self.last = Some((pose.stamp, pose.position));
        Motion {
            position: pose.position,
            velocity: self.velocity,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ferntast_msgs::sample::Frame;

    #[test]
    fn a_steady_motion_has_its_velocity_and_a_gap_begins_anew() {
        let mut filter = VelocityFilter::default();
        let start = Time::from_nanos(1_000_000_000_000);
        let mut motion = Motion::default();
        for tick in 0..100 {
            let position = [0.2e-3 * tick as f64, 0.0, 0.0];
            let stamp = start.plus_nanos(tick * 1_000_000);
            motion = filter.step(&PoseSample::at(stamp, Frame::LEADER_BASE, position));
        }
        assert!((motion.velocity[0] - 0.2).abs() < 1e-6, "{motion:?}");
        let late = start.plus_nanos(1_000_000_000);
        motion = filter.step(&PoseSample::at(late, Frame::LEADER_BASE, [1.0, 0.0, 0.0]));
        assert_eq!(motion.velocity, [0.0; 3]);
    }
}
