//! Joints that are read otherwise than the model has them: the other way round, in another order, a
//! quarter of a turn elsewhere.
//!
//! With a torque of the wrong sign anything may look as if it were missing, so that this is asked before
//! effects are. A model of links, inertia of motors, Coulomb and viscous friction, which are not negative,
//! is put to a few samples of all joints read in one way and another; what is read wrongly is
//! told from what is missing by how much it explains.

use std::f64::consts::FRAC_PI_2;
use std::ops::RangeInclusive;

use ferntast_model::Joints;
use ferntast_model::friction::JointType;
use nalgebra::{Matrix3, Vector3};
use serde::Serialize;

use super::prepared::PreparedArm;
use super::rigid_body::RigidBody;
use crate::data::Inertia;

/// Samples that are looked at.
const SAMPLES: usize = 400;
/// A joint of whose torque less than this share is left is read rightly.
const SUSPECT: f64 = 0.15;
/// By how much the logarithms of the joints' errors fall, together, for another reading to be the right
/// one: one error to a third, or several by less.
const MIN_FALL: f64 = 1.1;
/// A joint that was read wrongly has at most this share of its error left: else it is the model that is
/// wrong, of which another reading makes up for something.
const LEFT: f64 = 1.0 / 3.0;
/// By how much they rise if one part of it is taken back, for that to stay.
const MIN_PART: f64 = 0.2;
/// What a part has to explain for a reading with it to be better than one without.
const PART: f64 = 0.02;
/// Smallest error that counts, as a share of the torque: below, friction has more to say.
const LEAST: f64 = 0.02;

/// A joint that is read otherwise than the model has it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Misread {
    /// Its name in the model.
    pub joint: String,
    /// Its position and its torque count the other way round.
    pub reversed: bool,
    /// Its torque does, or does not where all else is reversed.
    pub torque_reversed: bool,
    /// What has to be added to its position, quarters of a turn \[rad\].
    pub zero: f64,
    /// The joint whose position and torque are read as this one's, in truth.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub is_read_as: Option<String>,
    /// The joint whose torque is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub torque_is_read_as: Option<String>,
    /// RMS of what is left of its torque as it is read \[Nm\].
    pub error_before: f64,
    /// The same read in the other way.
    pub error_after: f64,
}

/// How one joint is read.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Reading {
    /// Whose position it has, …
    position_of: usize,
    /// … and whose torque.
    torque_of: usize,
    /// ±1.
    direction: f64,
    /// ±1.
    torque: f64,
    /// Quarters of a turn.
    quarters: u8,
}

/// Joints that are read otherwise than the model has them.
pub(super) fn find(arm: &PreparedArm<'_>) -> Vec<Misread> {
    let looked = Samples::new(arm);
    let as_read: Vec<Reading> = (0..looked.joints).map(Reading::plain).collect();
    let before = looked.errors(&as_read);
    let mut sizes = before.iter().zip(&looked.sizes);
    if !sizes.any(|(error, size)| *error > SUSPECT * size) {
        return Vec::new();
    }
    let best = looked.search(&as_read);
    if looked.score(&best) > looked.score(&as_read) - MIN_FALL {
        return Vec::new();
    }
    let after = looked.errors(&best);
    let name = |at: usize| arm.joint_named(at).0;
    let changed = (best.iter().zip(&as_read).enumerate()).filter(|(_, (now, then))| now != then);
    let is_mended = |at: usize| {
        // Of a joint that was explained before, too, as of one that the others are turned with, little
        // has to become less.
        let was_explained = before[at] <= SUSPECT * looked.sizes[at];
        after[at] < LEFT * before[at] || (was_explained && after[at] < 1.1 * before[at])
    };
    if !changed.clone().all(|(at, _)| is_mended(at)) {
        return Vec::new();
    }
    let told = changed.map(|(at, (now, _))| Misread {
        joint: name(at),
        reversed: now.direction < 0.0,
        torque_reversed: now.direction * now.torque < 0.0,
        zero: signed(now.quarters) * FRAC_PI_2,
        is_read_as: (now.position_of != at).then(|| name(now.position_of)),
        torque_is_read_as: (now.torque_of != at && now.position_of == at)
            .then(|| name(now.torque_of)),
        error_before: before[at],
        error_after: after[at],
    });
    told.collect()
}

/// Three quarters are one back.
fn signed(quarters: u8) -> f64 {
    match quarters {
        3 => -1.0,
        own => f64::from(own),
    }
}

impl Reading {
    /// As the model has it.
    const fn plain(joint: usize) -> Self {
        Self {
            position_of: joint,
            torque_of: joint,
            direction: 1.0,
            torque: 1.0,
            quarters: 0,
        }
    }

    /// In how many ways it is other than the model has joint number `at`.
    fn parts(&self, at: usize) -> usize {
        let other = [
            self.position_of != at,
            self.torque_of != at,
            self.direction < 0.0,
            self.direction * self.torque < 0.0,
            self.quarters != 0,
        ];
        other.into_iter().filter(|own| *own).count()
    }

    /// The other ways to read the same channels.
    fn others(self, kind: JointType) -> Vec<Self> {
        let quarters = match kind {
            JointType::Revolute => 4,
            _ => 1,
        };
        let signs = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];
        let all = signs.into_iter().flat_map(|[direction, torque]| {
            (0..quarters).map(move |quarters| Self {
                direction,
                torque,
                quarters,
                ..self
            })
        });
        all.filter(|own| *own != self).collect()
    }
}

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

/// Some samples of all joints.
struct Samples<'a> {
    body: RigidBody<'a>,
    joints: usize,
    kinds: Vec<JointType>,
    armature: Vec<Option<f64>>,
    motion: Vec<[Joints<f64>; 3]>,
    /// By joint and sample \[Nm\].
    torques: Vec<Vec<f64>>,
    /// RMS of these.
    sizes: Vec<f64>,
}

impl<'a> Samples<'a> {
    fn new(arm: &PreparedArm<'a>) -> Self {
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
            motion,
            torques,
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

    /// What each joint's torque is beyond the links' \[Nm\], with the motion that goes with it.
    fn errors(&self, readings: &[Reading]) -> Vec<f64> {
        let mut sums = vec![Sums::default(); self.joints];
        let body = self.body.ready();
        for (number, sample) in self.motion.iter().enumerate() {
            let [q, qd, qdd] = self.read(readings, sample);
            let links = body.torques_at(&q, &qd, &qdd);
            for (at, (sums, reading)) in sums.iter_mut().zip(readings).enumerate() {
                let measured = reading.torque * self.torques[reading.torque_of][number];
                let armature = self.armature.get(at).copied().flatten();
                let known = links[at] + armature.unwrap_or(0.0) * qdd[at];
                let free = if armature.is_some() { 0.0 } else { qdd[at] };
                let sign = if qd[at] == 0.0 { 0.0 } else { qd[at].signum() };
                sums.add(Vector3::new(free, sign, qd[at]), measured - known);
            }
        }
        sums.iter().map(Sums::error).collect()
    }

    /// Sum of the logarithms of the joints' errors over their torques; of readings that explain as
    /// much, as of an arm and its mirror image, that with fewer parts is less.
    fn score(&self, readings: &[Reading]) -> f64 {
        let each = self.errors(readings).into_iter().zip(&self.sizes);
        let each = each.map(|(error, size)| (error / size.max(1e-12)).max(LEAST).ln());
        let parts: usize = (readings.iter().enumerate())
            .map(|(at, own)| own.parts(at))
            .sum();
        each.sum::<f64>() + PART * parts as f64
    }

    /// The way to read all joints that explains most, from where they are as they are read, or all the
    /// other way round.
    fn search(&self, as_read: &[Reading]) -> Vec<Reading> {
        let turned = |direction: f64, torque: f64| -> Vec<Reading> {
            let each = as_read.iter().map(|own| Reading {
                direction,
                torque,
                ..*own
            });
            each.collect()
        };
        let starts = [as_read.to_vec(), turned(1.0, -1.0), turned(-1.0, -1.0)];
        let found = starts.map(|start| self.search_from(start));
        let [first, others @ ..] = found;
        let (mut best, mut score) = first;
        for (readings, own) in others {
            if own < score - MIN_PART {
                (best, score) = (readings, own);
            }
        }
        self.without_idle_parts(best, score)
    }

    /// One joint after the other in the other way that explains most, until none explains much.
    fn search_from(&self, start: Vec<Reading>) -> (Vec<Reading>, f64) {
        let mut score = self.score(&start);
        let mut best = start;
        for _ in 0..2 * self.joints {
            let tried = self.around(&best).into_iter();
            let tried = tried.map(|own| (self.score(&own), own));
            let least = tried.min_by(|a, b| a.0.total_cmp(&b.0));
            match least.filter(|(next, _)| *next < score - MIN_FALL) {
                Some((next, readings)) => (best, score) = (readings, next),
                None => break,
            }
        }
        (best, score)
    }

    /// Without the parts that explain nothing by themselves.
    fn without_idle_parts(&self, mut best: Vec<Reading>, mut score: f64) -> Vec<Reading> {
        for at in 0..self.joints {
            let own = best[at];
            let idle = [
                Reading { quarters: 0, ..own },
                Reading {
                    direction: 1.0,
                    torque: own.direction * own.torque,
                    ..own
                },
                Reading {
                    torque: own.direction,
                    ..own
                },
            ];
            for simpler in idle {
                let mut tried = best.clone();
                tried[at] = simpler;
                if tried != best {
                    let without = self.score(&tried);
                    if without < score + MIN_PART {
                        (best, score) = (tried, without);
                    }
                }
            }
        }
        best
    }

    /// Every way to read all joints that differs in one, or in the order or the directions of two.
    fn around(&self, readings: &[Reading]) -> Vec<Vec<Reading>> {
        let mut all = Vec::new();
        for (at, own) in readings.iter().enumerate() {
            for other in own.others(self.kinds[at]) {
                let mut tried = readings.to_vec();
                tried[at] = other;
                all.push(tried);
            }
            for with in 0..at {
                let mut tried = readings.to_vec();
                let [one, two] = [readings[at].torque_of, readings[with].torque_of];
                (tried[at].torque_of, tried[with].torque_of) = (two, one);
                all.push(tried.clone());
                let [one, two] = [readings[at].position_of, readings[with].position_of];
                (tried[at].position_of, tried[with].position_of) = (two, one);
                all.push(tried);
                let mut tried = readings.to_vec();
                for own in [at, with] {
                    tried[own].direction *= -1.0;
                    tried[own].torque *= -1.0;
                }
                all.push(tried);
            }
        }
        all
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
