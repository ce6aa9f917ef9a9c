//! Some samples of all joints, and what a model of links, motors and friction leaves of them.

use std::f64::consts::FRAC_PI_2;
use std::ops::RangeInclusive;

use ferntast_model::Joints;
use ferntast_model::friction::JointType;
use nalgebra::{Matrix3, Vector3};

use super::super::prepared::PreparedArm;
use super::super::rigid_body::RigidBody;
use super::reading::Reading;
use crate::data::Inertia;

/// Samples that are looked at.
const SAMPLES: usize = 400;

/// Samples of a session that lie where filters of no joint look beyond it.
fn within(arm: &PreparedArm<'_>, session: usize) -> RangeInclusive<usize> {
    let rows = arm
        .joints
        .iter()
        .filter_map(|joint| joint.prepared.sessions.get(session));
    let ends = rows.filter_map(|own| Some((*own.rows.first()?, *own.rows.last()?)));
    let (first, last) = ends.fold((0, usize::MAX), |(first, last), own| {
        (first.max(own.0), last.min(own.1))
    });
    let length = arm.motion.states.get(session).map_or(0, |own| own.len());
    first..=last.min(length.saturating_sub(1))
}

/// A joint in a sample.
pub struct Seen {
    /// What its links and the motor's inertia, where that is known, need \[Nm\].
    pub known: f64,
    /// What goes with its friction and with an inertia that is free: q̈ (else 0), sign of q̇, q̇.
    pub free: Vector3<f64>,
    /// Its torque \[Nm\].
    pub torque: f64,
}

/// Some samples of all joints.
pub struct Samples<'a> {
    body: RigidBody<'a>,
    pub joints: usize,
    pub kinds: Vec<JointType>,
    armature: Vec<Option<f64>>,
    motion: Vec<[Joints<f64>; 3]>,
    /// By joint and sample \[Nm\].
    torques: Vec<Vec<f64>>,
    /// RMS of these.
    pub sizes: Vec<f64>,
    /// Whose errors count.
    pub counts: Vec<bool>,
}

impl<'a> Samples<'a> {
    pub fn new(arm: &PreparedArm<'a>) -> Self {
        let joints = arm.joints.len();
        let states = &arm.motion.states[..arm.motion.fitted];
        let count: usize = states.iter().map(|own| own.len()).sum();
        let step = count.div_ceil(SAMPLES).max(1);
        let mut motion = Vec::new();
        let mut torques = vec![Vec::new(); joints];
        for (number, (states, session)) in states.iter().zip(&arm.motion.sessions).enumerate() {
            for at in within(arm, number).step_by(step) {
                motion.push([states.q[at], states.qd[at], states.qdd[at]]);
                for (own, measured) in torques.iter_mut().zip(&session.motor_torque) {
                    own.push(measured.get(at).copied().unwrap_or(0.0));
                }
            }
        }
        Self {
            body: arm.body(),
            joints,
            kinds: (0..joints).map(|at| arm.spec.joint_type(at)).collect(),
            armature: (arm.spec.armature.iter())
                .map(|own| match own {
                    Inertia::Given(armature) => Some(*armature),
                    Inertia::Fit => None,
                })
                .collect(),
            sizes: torques.iter().map(|own| rms(own)).collect(),
            counts: vec![true; joints],
            motion,
            torques,
        }
    }

    /// With torques of which 1 of those that are read is as much as `gains` says.
    pub fn scaled(mut self, gains: &[Option<f64>]) -> Self {
        let own = self.torques.iter_mut().zip(&mut self.sizes).zip(gains);
        for ((torques, size), gain) in own {
            let gain = gain.unwrap_or(1.0);
            torques.iter_mut().for_each(|torque| *torque *= gain);
            *size *= gain;
        }
        self
    }

    /// Goes through all joints of all samples, read in these ways.
    pub fn each(&self, readings: &[Reading], mut visit: impl FnMut(usize, &Seen)) {
        let body = self.body.ready();
        for (number, sample) in self.motion.iter().enumerate() {
            let [q, qd, qdd] = self.read(readings, sample);
            let links = body.torques_at(&q, &qd, &qdd);
            for (at, reading) in readings.iter().enumerate() {
                let armature = self.armature.get(at).copied().flatten();
                let free = if armature.is_some() { 0.0 } else { qdd[at] };
                let sign = if qd[at] == 0.0 { 0.0 } else { qd[at].signum() };
                let seen = Seen {
                    known: links[at] + armature.unwrap_or(0.0) * qdd[at],
                    free: Vector3::new(free, sign, qd[at]),
                    torque: reading.torque * self.torques[reading.torque_of][number],
                };
                visit(at, &seen);
            }
        }
    }

    /// All joints read in these ways.
    fn read(&self, readings: &[Reading], sample: &[Joints<f64>; 3]) -> [Joints<f64>; 3] {
        let mut read = *sample;
        for (order, own) in read.iter_mut().enumerate() {
            for (at, reading) in readings.iter().enumerate() {
                let zero = if order == 0 {
                    f64::from(reading.quarters) * FRAC_PI_2
                } else {
                    0.0
                };
                own[at] = reading.direction * sample[order][reading.position_of] + zero;
            }
        }
        read
    }

    /// What each joint's torque is beyond the links' and the motion that goes with it \[Nm\].
    pub fn errors(&self, readings: &[Reading]) -> Vec<f64> {
        let mut sums = vec![Sums::default(); self.joints];
        self.each(readings, |at, seen| {
            sums[at].add(seen.free, seen.torque - seen.known);
        });
        sums.iter().map(Sums::error).collect()
    }
}

/// Sums of least squares with three columns.
#[derive(Clone, Default)]
struct Sums {
    columns: Matrix3<f64>,
    with: Vector3<f64>,
    square: f64,
    count: f64,
}

impl Sums {
    fn add(&mut self, columns: Vector3<f64>, value: f64) {
        self.columns += columns * columns.transpose();
        self.with += columns * value;
        self.square += value * value;
        self.count += 1.0;
    }

    /// RMS of what the columns leave by coefficients that are not negative: the least over all choices
    /// of columns whose free fit is such.
    fn error(&self) -> f64 {
        let left = (0..8_usize).filter_map(|choice| {
            let is_chosen = |at: usize| choice >> at & 1 == 1;
            let columns = Matrix3::from_fn(|i, j| match is_chosen(i) && is_chosen(j) {
                true => self.columns[(i, j)],
                false => f64::from(u8::from(i == j)),
            });
            let with = Vector3::from_fn(|at, _| if is_chosen(at) { self.with[at] } else { 0.0 });
            let fitted = columns.try_inverse()? * with;
            let is_possible = fitted.iter().all(|own| *own >= 0.0);
            is_possible.then(|| self.square - fitted.dot(&with))
        });
        let least = left.fold(self.square, f64::min);
        (least.max(0.0) / self.count.max(1.0)).sqrt()
    }
}

fn rms(values: &[f64]) -> f64 {
    let square: f64 = values.iter().map(|own| own * own).sum();
    (square / values.len().max(1) as f64).sqrt()
}
