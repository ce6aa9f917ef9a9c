//! The motor torque on the times of the positions.

use std::collections::VecDeque;

use ferntast_msgs::{Time, sample::JointSample};

/// Positions that may wait for a motor torque.
const MAX_WAITING: usize = 64;
/// A position that is this much later than the motor torque \[ns\] is of another time.
const JUMP_NANOS: i64 = 500_000_000;

/// Joins the two topics: a position with its joint torque waits until a motor
/// torque of its time or later is there, which is taken straight between two
/// samples, as the lab does.
#[derive(Debug)]
pub(super) struct Alignment {
    joint: usize,
    waiting: VecDeque<JointSample>,
    last: Option<(Time, f64)>,
    dropped: u64,
}

/// A position with the motor torque of its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Aligned {
    pub(super) stamp: Time,
    /// \[rad\]
    pub(super) position: f64,
    /// \[Nm\]
    pub(super) joint_torque: f64,
    /// \[Nm\]
    pub(super) motor_torque: f64,
}

impl Alignment {
    /// Of joint `joint`, from 0.
    pub(super) fn new(joint: usize) -> Self {
        Self {
            joint,
            waiting: VecDeque::with_capacity(MAX_WAITING + 1),
            last: None,
            dropped: 0,
        }
    }

    /// Positions that met no motor torque though there were some.
    pub(super) fn dropped(&self) -> u64 {
        self.dropped
    }

    /// Takes `/follower/measured_js`.
    pub(super) fn measured(&mut self, sample: &JointSample) {
        self.waiting.push_back(*sample);
        if self.waiting.len() > MAX_WAITING {
            self.waiting.pop_front();
            self.dropped += 1;
        }
    }

    /// Takes `/follower/motor_js`; tells `each` what is complete with it.
    pub(super) fn motor(&mut self, sample: &JointSample, mut each: impl FnMut(Aligned)) {
        let Some(&to) = sample.effort.get(self.joint) else {
            return;
        };
        let before = self.last.replace((sample.stamp, to));
        while let Some(measured) = self.waiting.front() {
            let ahead = measured.stamp.nanos_since(sample.stamp);
            if ahead > 0 && ahead < JUMP_NANOS {
                return;
            }
            let torque = match before {
                _ if ahead == 0 => Some(to),
                Some((from_time, from)) if ahead < 0 && measured.stamp >= from_time => {
                    let whole = sample.stamp.seconds_since(from_time);
                    let part = measured.stamp.seconds_since(from_time);
                    Some(from + (to - from) * part / whole)
                }
                _ => None,
            };
            let position = measured.position.get(self.joint).copied();
            let joint_torque = measured.effort.get(self.joint).copied();
            match (torque, position, joint_torque) {
                (Some(motor_torque), Some(position), Some(joint_torque)) => each(Aligned {
                    stamp: measured.stamp,
                    position,
                    joint_torque,
                    motor_torque,
                }),
                // Before the first motor torque there was nothing to meet.
                _ => self.dropped += u64::from(before.is_some()),
            }
            self.waiting.pop_front();
        }
    }
}

#[cfg(test)]
mod tests {
    use ferntast_msgs::sample::JointNames;

    use super::*;

    fn at(millis: i64) -> Time {
        Time::from_nanos(1_000_000_000_000 + millis * 1_000_000)
    }

    fn run(order: &[(char, i64)]) -> (Vec<(i64, f64)>, u64) {
        let joints = JointNames::numbered(2);
        let mut alignment = Alignment::new(1);
        let mut out = Vec::new();
        for &(topic, millis) in order {
            match topic {
                'p' => alignment
                    .measured(&JointSample::empty(joints, at(millis)).with_position([0.0, 1.0])),
                // The torque is the time.
                _ => alignment.motor(
                    &JointSample::empty(joints, at(millis)).with_effort([0.0, millis as f64]),
                    |aligned| {
                        let millis = aligned.stamp.nanos_since(at(0)) / 1_000_000;
                        out.push((millis, aligned.motor_torque));
                    },
                ),
            }
        }
        (out, alignment.dropped())
    }

    #[test]
    fn same_times_pass_at_once_and_others_between() {
        let (out, dropped) = run(&[('p', 0), ('m', 0), ('p', 3), ('p', 8), ('m', 4), ('m', 10)]);
        assert_eq!(out, [(0, 0.0), (3, 3.0), (8, 8.0)]);
        assert_eq!(dropped, 0);
    }

    #[test]
    fn what_never_meets_a_torque_is_dropped_and_counted() {
        // Before the first torque; then time starts over.
        let (out, dropped) = run(&[('p', 0), ('m', 4), ('p', 9000), ('p', 10), ('m', 10)]);
        assert_eq!(out, [(10, 10.0)]);
        assert_eq!(dropped, 1);
        let many: Vec<(char, i64)> = (0..100).map(|k| ('p', k)).collect();
        assert_eq!(run(&many), (vec![], 36));
    }
}
