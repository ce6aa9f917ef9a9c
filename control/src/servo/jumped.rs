//! Measurements that are elsewhere than a joint can have got to: an encoder that has lost
//! its zero, or counts wrongly.

use super::Measurement;
use crate::planted::{Planted, Rule};
use crate::seconds;
use ferntast_model::Joints;

/// Beyond what the fastest joint moves between two measurements \[rad\]: stamps that are
/// late, noise.
const MARGIN: f64 = 0.01;

/// Compares each measurement with the one before.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct JumpWatch {
    last: Option<Measurement>,
    pub(super) planted: Planted,
}

impl JumpWatch {
    /// Notes `measured`, of joints that are a fault above `overspeed` \[rad/s\]. Gives the
    /// number of the joint (from 1) that cannot have got there.
    pub(super) fn step(&mut self, measured: &Measurement, overspeed: &Joints<f64>) -> Option<u8> {
        let before = self.last.replace(*measured)?;
        if self.planted.lacks(Rule::JumpWatch) {
            return None;
        }
        let passed = seconds(measured.stamp_ns.saturating_sub(before.stamp_ns)).max(0.0);
        let positions = measured.position.iter().zip(before.position.iter());
        let mut joints = positions.zip(overspeed.iter());
        let far = joints.position(|((now, before), overspeed)| {
            (now - before).abs() > overspeed * passed + MARGIN
        })?;
        u8::try_from(far + 1).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ferntast_model::JointCount;

    const MS: i64 = 1_000_000;

    fn measured(ms: i64, second: f64) -> Measurement {
        let count = JointCount::new(2).unwrap();
        let filled = Joints::filled(count, 0.0);
        Measurement {
            stamp_ns: 1_700_000_000_000_000_000 + ms * MS,
            position: Joints::from_fn(count, |joint| if joint == 1 { second } else { 0.3 }),
            velocity: filled,
            torque: filled,
        }
    }

    fn told(samples: &[(i64, f64)]) -> Option<u8> {
        let mut watch = JumpWatch::default();
        let overspeed = Joints::filled(JointCount::new(2).unwrap(), 1.0);
        let mut samples = samples.iter();
        samples.find_map(|(ms, position)| watch.step(&measured(*ms, *position), &overspeed))
    }

    #[test]
    fn a_joint_that_is_elsewhere_at_once_is_told() {
        // 1 mrad in a millisecond, and 10 mrad of margin.
        assert_eq!(told(&[(0, 0.5), (1, 0.512)]), Some(2));
        assert_eq!(told(&[(0, 0.5), (1, 0.488)]), Some(2));
        assert_eq!(told(&[(0, 0.5), (1, 0.510), (2, 0.520)]), None);
    }

    #[test]
    fn what_moved_while_nobody_looked_is_no_jump() {
        assert_eq!(told(&[(0, 0.0), (200, 0.2)]), None);
        assert_eq!(told(&[(0, 0.0), (200, 0.25)]), Some(2));
        // The first, the same again, a clock that goes back.
        assert_eq!(told(&[(0, 2.0), (0, 2.0), (-4, 2.001)]), None);
    }
}
