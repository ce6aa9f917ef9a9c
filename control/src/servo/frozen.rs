//! Measurements that stand still though the arm cannot: a sensor, or what reads it, that
//! gives the same numbers again and again under new stamps.
//!
//! A joint that is at rest looks like that, too, where its sensors are coarse and quiet.
//! So equal numbers count only together with one of two contradictions: the velocity
//! among them would have moved the joint meanwhile; or the motor's torque has changed by
//! more than friction hides, and a joint torque that is measured did not follow.

use super::Measurement;
use crate::planted::{Planted, Rule};
use crate::seconds;
use ferntast_model::Joints;

/// Equal measurements in a row before anything is concluded.
const SAMPLES: u32 = 10;
/// How far a joint would have moved \[rad\]: more than a step of a coarse encoder.
const TRAVEL: f64 = 5e-3;
/// By which share of its limit a motor's torque changes, from the least to the most.
const TORQUE_SHARE: f64 = 0.3;

/// Compares each measurement with those before.
#[derive(Clone, Debug, Default)]
pub(super) struct FrozenWatch {
    /// The first of the equal ones.
    first: Option<Measurement>,
    last_ns: i64,
    samples: u32,
    /// Torques of the motors meanwhile, least and most \[Nm\].
    torques: Option<(Joints<f64>, Joints<f64>)>,
    pub(super) planted: Planted,
}

impl FrozenWatch {
    /// Notes `measured`, after the motors were `given` torques \[Nm\] of at most `limits`
    /// \[Nm\]. Gives the number of the joint (from 1) whose measurement cannot be true.
    pub(super) fn step(
        &mut self,
        measured: &Measurement,
        given: Joints<f64>,
        limits: &Joints<f64>,
    ) -> Option<u8> {
        let equal = self.first.is_some_and(|first| {
            let own = Measurement {
                stamp_ns: first.stamp_ns,
                ..*measured
            };
            own == first
        });
        let first = match self.first {
            Some(first) if equal => first,
            _ => {
                self.first = Some(*measured);
                self.last_ns = measured.stamp_ns;
                self.samples = 1;
                self.torques = Some((given, given));
                return None;
            }
        };
        if measured.stamp_ns == self.last_ns {
            return None;
        }
        self.last_ns = measured.stamp_ns;
        self.samples += 1;
        let (least, most) = self.torques.get_or_insert((given, given));
        for (joint, own) in given.iter().enumerate() {
            least[joint] = least[joint].min(*own);
            most[joint] = most[joint].max(*own);
        }
        if self.samples < SAMPLES || self.planted.lacks(Rule::FrozenWatch) {
            return None;
        }
        let passed = seconds(measured.stamp_ns.saturating_sub(first.stamp_ns));
        // Zeros stand for a torque that is not measured.
        let sensed = measured.torque.iter().any(|own| *own != 0.0);
        let frozen = (0..given.len()).find(|&joint| {
            let moved = measured.velocity[joint].abs() * passed > TRAVEL;
            let pushed = most[joint] - least[joint] > TORQUE_SHARE * limits[joint];
            moved || (sensed && pushed)
        });
        frozen.and_then(|joint| u8::try_from(joint + 1).ok())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ferntast_model::JointCount;

    const MS: i64 = 1_000_000;

    fn measured(ms: i64, velocity: f64, torque: f64) -> Measurement {
        let count = JointCount::new(2).unwrap();
        Measurement {
            stamp_ns: 1_700_000_000_000_000_000 + ms * MS,
            position: Joints::filled(count, 0.5),
            velocity: Joints::from_fn(count, |joint| if joint == 1 { velocity } else { 0.0 }),
            torque: Joints::filled(count, torque),
        }
    }

    fn motors(second: f64) -> Joints<f64> {
        let count = JointCount::new(2).unwrap();
        Joints::from_fn(count, |joint| if joint == 1 { second } else { 0.0 })
    }

    fn limits() -> Joints<f64> {
        Joints::filled(JointCount::new(2).unwrap(), 80.0)
    }

    /// When it is told that which joint is frozen, with the torque of the second motor at
    /// each millisecond.
    fn told(velocity: f64, torque: f64, given: impl Fn(i64) -> f64) -> Option<(i64, u8)> {
        let mut watch = FrozenWatch::default();
        (0..1000).find_map(|ms| {
            let measured = measured(ms, velocity, torque);
            let joint = watch.step(&measured, motors(given(ms)), &limits())?;
            Some((ms, joint))
        })
    }

    #[test]
    fn a_joint_that_should_have_moved_is_found() {
        // 5 mrad at 0.098 rad/s take 51.02 ms.
        assert_eq!(told(0.098, 1.0, |_| 0.0), Some((52, 2)));
        assert_eq!(told(-10.0, 0.0, |_| 0.0), Some((9, 2)));
    }

    #[test]
    fn a_torque_that_is_not_followed_is_found_where_torques_are_measured() {
        // A quarter of a newton metre a millisecond: 24 Nm of 80 Nm.
        let rises = |ms: i64| 0.25 * ms as f64;
        assert_eq!(told(0.0, 1.0, rises), Some((97, 2)));
        assert_eq!(told(0.0, 0.0, rises), None);
    }

    #[test]
    fn rest_is_no_fault() {
        assert_eq!(told(0.0, 1.0, |ms| 11.0 * (ms % 3 - 1) as f64), None);
        assert_eq!(told(0.004, 1.0, |_| 40.0), None);
    }

    #[test]
    fn noise_is_no_fault_nor_is_the_same_measurement_given_often() {
        let mut watch = FrozenWatch::default();
        for ms in 0..1000_i64 {
            let noisy = measured(ms, 1.0, 1.0 + 1e-9 * (ms % 2) as f64);
            assert_eq!(watch.step(&noisy, motors(ms as f64), &limits()), None);
        }
        let mut watch = FrozenWatch::default();
        for ms in 0..1000_i64 {
            let same = measured(0, 1.0, 1.0);
            assert_eq!(watch.step(&same, motors(ms as f64), &limits()), None);
        }
    }
}
