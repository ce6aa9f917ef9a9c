//! Any serial arm: its tip is led by damped steps of inverse kinematics.
//!
//! While the tip goes along, an arm of six joints or more turns its tool as the hand turns
//! ([`turning`](super::turning)), or holds the orientation that it has at home, and what that leaves
//! free goes towards home. A tool that is turned is asked for no more than one command's turn
//! from where it has come to, so that one that cannot follow, at a singularity or at a joint's end,
//! stays behind and does not pull the tip away. One command leads a few
//! steps at most. Near a singularity each is as long as that one is away
//! ([`inverse_kinematics`](ferntast_model::rigid_body::inverse_kinematics)): the arm slows, and
//! stands before it. Where the last look found none within reach, steps are the same without
//! the looking, Δq = h + J⁺ (e − J h) with h towards home.

use super::tip::{Led, TipKinematics, Turn};
use super::{CommandRefusal, Range};
use ferntast_model::rigid_body::inverse_kinematics::{MOBILITY_CHANGE, Settings, Task, motion_to};
use ferntast_model::rigid_body::{Chain, Jacobian, Placement};
use ferntast_model::serial_arm::SerialArm;
use ferntast_model::{JointCount, Joints, MAX_JOINTS};
use nalgebra::{Matrix3, Matrix6, Rotation3, SVector, UnitQuaternion, Vector3, Vector6};

/// Steps that one command leads at most: 40 mrad of all joints together near a singularity,
/// 160 mrad elsewhere.
const STEPS: usize = 16;
/// Longest step away from singularities \[rad\].
const LONGEST: f64 = 0.01;
/// So near the tip is where it was to be \[m\], \[rad\].
const NEAR: f64 = 1e-6;
const ALIKE: f64 = 1e-6;
/// A tip that stays further away than this \[m\] and comes no nearer is not within reach.
const FAR: f64 = 2e-3;
/// By so much a command leads it nearer that can be followed, as a share of what is left.
const PROGRESS: f64 = 1e-3;

/// The arm's links with how they are led.
#[derive(Clone, Debug)]
pub(super) struct SerialTip {
    chain: Chain,
    home: Joints<f64>,
    orientation: Matrix3<f64>,
    settings: Settings,
}

impl SerialTip {
    pub(super) fn new(arm: &SerialArm) -> SerialTip {
        let task = match arm.turns_tool() {
            true => Task::Pose,
            false => Task::Position,
        };
        SerialTip {
            chain: arm.chain().clone(),
            home: *arm.home(),
            orientation: arm.home_tip().rotation,
            settings: Settings {
                task,
                ..Settings::default()
            },
        }
    }

    /// How far the tip is from `target`: the motion that is left, \[m\], and \[rad\] where
    /// that counts.
    fn left(&self, tip: &Placement, target: &Placement) -> (Vector6<f64>, [f64; 2]) {
        let mut left = motion_to(tip, target);
        if self.settings.task == Task::Position {
            left.fixed_rows_mut::<3>(3).fill(0.0);
        }
        let part = |from| left.fixed_rows::<3>(from).norm();
        (left, [part(0), part(3)])
    }

    /// A step where no singularity is near; `None` where it would not be a plain one: beyond a
    /// joint's end, or without a solution.
    fn plain_step(
        &self,
        q: &Joints<f64>,
        jacobian: &Jacobian,
        left: &Vector6<f64>,
    ) -> Option<(Joints<f64>, f64)> {
        let mut jacobian = *jacobian;
        if self.settings.task == Task::Position {
            jacobian.fixed_rows_mut::<3>(3).fill(0.0);
        }
        let homing = SVector::<f64, MAX_JOINTS>::from_fn(|joint, _| match q.get(joint) {
            Some(q) => self.settings.homing * (self.home[joint] - q),
            None => 0.0,
        });
        let mut square: Matrix6<f64> = jacobian * jacobian.transpose();
        if self.settings.task == Task::Position {
            square.fixed_view_mut::<3, 3>(3, 3).fill_with_identity();
        }
        let solved = square.cholesky()?.solve(&(left - jacobian * homing));
        let change = homing + jacobian.tr_mul(&solved);
        let length = change.norm();
        if !length.is_finite() {
            return None;
        }
        let scale = (LONGEST / length).min(1.0);
        let limits = self.chain.limits();
        let moved = Joints::from_fn(q.count(), |joint| q[joint] + scale * change[joint]);
        let within = (0..q.len())
            .all(|joint| (limits[joint].lower..=limits[joint].upper).contains(&moved[joint]));
        within.then_some((moved, scale * length))
    }

    /// Of a least singular value, how far the joints may go until damping begins \[rad\].
    fn clear(&self, mobility: f64) -> f64 {
        // An arm of fewer joints than rows is always looked at closely.
        let rows = match self.settings.task {
            Task::Position => 3,
            Task::Pose => 6,
        };
        match self.home.len() < rows {
            true => 0.0,
            false => ((mobility - self.settings.slow_below) / MOBILITY_CHANGE).max(0.0),
        }
    }
}

/// `from`, turned towards where it is to be as far as one command does.
fn turned(from: &Matrix3<f64>, turn: &Turn) -> Matrix3<f64> {
    let from = quaternion(*from);
    let left = (turn.to * from.inverse()).scaled_axis();
    let angle = left.norm();
    let to = match angle <= turn.most {
        true => turn.to,
        false => UnitQuaternion::from_scaled_axis(left * (turn.most / angle)) * from,
    };
    to.to_rotation_matrix().into_inner()
}

fn quaternion(rotation: Matrix3<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation))
}

impl TipKinematics for SerialTip {
    fn count(&self) -> JointCount {
        self.chain.count()
    }

    fn followed(&self, tip: &Vector3<f64>) -> Vector3<f64> {
        *tip
    }

    fn tip(&self, joints: &Joints<f64>) -> Result<Vector3<f64>, CommandRefusal> {
        match joints.count() == self.count() {
            true => Ok(self.chain.forward(joints).translation),
            false => Err(CommandRefusal::NoTipModel),
        }
    }

    fn orientation(&self, joints: &Joints<f64>) -> Option<UnitQuaternion<f64>> {
        let turns = self.settings.task == Task::Pose && joints.count() == self.count();
        turns.then(|| quaternion(self.chain.forward(joints).rotation))
    }

    fn joints(
        &self,
        tip: &Vector3<f64>,
        turn: Option<&Turn>,
        posture: &Joints<f64>,
        last: Option<&Led>,
    ) -> Result<Led, CommandRefusal> {
        let mut led = last.copied().unwrap_or(Led {
            joints: *posture,
            clear: 0.0,
        });
        if led.joints.count() != self.count() {
            return Err(CommandRefusal::NoTipModel);
        }
        let (mut place, mut jacobian) = self.chain.forward_and_jacobian(&led.joints);
        let target = Placement {
            rotation: match turn {
                Some(turn) => turned(&place.rotation, turn),
                None => self.orientation,
            },
            translation: *tip,
        };
        let (mut left, begun) = self.left(&place, &target);
        let mut distance = begun;
        for _ in 0..STEPS {
            if distance[0] <= NEAR && distance[1] <= ALIKE {
                return Ok(led);
            }
            let plain = (led.clear > LONGEST)
                .then(|| self.plain_step(&led.joints, &jacobian, &left))
                .flatten();
            led = match plain {
                Some((joints, way)) => Led {
                    joints,
                    clear: led.clear - way,
                },
                None => {
                    let settings = &self.settings;
                    let step = settings.step(&self.chain, &led.joints, &left, &self.home);
                    if step.held {
                        break;
                    }
                    let before = led.joints.iter().zip(step.q.iter());
                    let way = before.map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
                    Led {
                        joints: step.q,
                        clear: self.clear(step.mobility) - way,
                    }
                }
            };
            (place, jacobian) = self.chain.forward_and_jacobian(&led.joints);
            (left, distance) = self.left(&place, &target);
        }
        let advances = distance[0] < (1.0 - PROGRESS) * begun[0];
        if distance[0] > FAR && !advances {
            let limit = Range::Reach;
            return Err(CommandRefusal::OutOfRange { limit });
        }
        Ok(led)
    }
}

#[cfg(test)]
mod tests;
