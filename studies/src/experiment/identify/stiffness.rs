//! Stiffness of joint 2 (Fig. 15).

use std::path::Path;

use ferntast_identification::experiments::stiffness::{self, Stiffness};
use ferntast_model::{
    Vector2,
    arm::Arm,
    contour::{Feature, Surface},
};
use ferntast_sim::arm::{ArmConfig, JOINTS};

use super::{IdentifyError, JointData, arm_of, systematic::Source};

/// Rounds of Newton's method for where the edge holds the link.
const ROUNDS: usize = 4;

/// Stiffness of joint 2 from the recording of a saw-tooth at `path`.
///
/// Motor, gear and link give θ_2 − q_2 = τ_2/K_2. The link's position is where the edge holds
/// the tip, with joint 1 as it is measured, q_1 = θ_1 − τ_1/K_1: Φ(q_1, q_2) = −F_N/k, with the
/// edge's believed stiffness k. F_N comes from both joints' torques, since the tip is also held
/// along the edge, by friction: joint 2's torque alone says too much of it.
///
/// The standard error has in it what is wrong with the torque sensors and the edge's direction
/// all the time: K_2 is identified again with each changed by its standard uncertainty.
///
/// # Errors
///
/// A recording that cannot be read, or has no saw-tooth.
pub fn stiffness(path: &Path) -> Result<Stiffness, IdentifyError> {
    let empty = || IdentifyError::Empty {
        path: path.to_owned(),
        what: "no torque against a fixed tip; record it with `ferntast experiment stiffness`",
    };
    let arm = arm_of(path)?;
    let joints = [JointData::read(path, 1)?, JointData::read(path, 2)?];
    let channels = |joint: &JointData| {
        let session = joint.dataset.sessions.first()?;
        Some((session.position.clone(), session.joint_torque.clone()?))
    };
    let [first, second] = joints.each_ref().map(channels);
    let ((theta_1, torque_1), (theta_2, torque_2)) = first.zip(second).ok_or_else(empty)?;
    let edge = arm
        .contour
        .features()
        .into_iter()
        .find(|feature| feature.surface == Surface::Unlubricated)
        .ok_or_else(empty)?;
    let pressed = Pressed {
        arm: &arm,
        position: [theta_1, theta_2],
    };
    let torque = [torque_1, torque_2];
    let found = pressed.stiffness(&torque, &edge).ok_or_else(empty)?;
    let uncertainty = arm.estimator.uncertainty;
    let mut changes = Vec::new();
    for (joint, source) in
        (0..JOINTS).flat_map(|joint| Source::of_joint(joint).map(|source| (joint, source)))
    {
        let Some(change) = source.change(&torque[joint], &uncertainty) else {
            continue;
        };
        let mut spoilt = torque.clone();
        for (torque, change) in spoilt[joint].iter_mut().zip(change) {
            *torque += change;
        }
        let other = pressed.stiffness(&spoilt, &edge).ok_or_else(empty)?;
        changes.push(other.stiffness - found.stiffness);
    }
    let turned = edge.turned(uncertainty.contour_turn);
    let other = pressed.stiffness(&torque, &turned).ok_or_else(empty)?;
    changes.push(other.stiffness - found.stiffness);
    Ok(found.with_systematic(&changes))
}

/// An arm that presses against an edge.
struct Pressed<'a> {
    arm: &'a ArmConfig,
    /// θ of both joints \[rad\], sample by sample.
    position: [Vec<f64>; JOINTS],
}

impl Pressed<'_> {
    /// With `torque` τ of both joints \[Nm\], the tip on `edge`.
    fn stiffness(&self, torque: &[Vec<f64>; JOINTS], edge: &Feature) -> Option<Stiffness> {
        let link = self.link(torque, edge);
        stiffness::stiffness(&self.position[1], &link, &torque[1])
    }

    /// q_2 \[rad\], sample by sample, as `edge` and joint 1 have it.
    fn link(&self, torque: &[Vec<f64>; JOINTS], edge: &Feature) -> Vec<f64> {
        let believed = Arm::new(&self.arm.arm);
        let kinematics = *believed.kinematics();
        let of = |joint: usize, at: usize| torque[joint].get(at).copied().unwrap_or(0.0);
        (0..self.position[1].len())
            .map(|at| {
                let felt = Vector2::new(of(0, at), of(1, at));
                let mut q = Vector2::from_fn(|joint, _| {
                    let theta = self.position[joint].get(at).copied().unwrap_or(0.0);
                    let own = self.arm.joint.get(joint);
                    own.map_or(theta, |own| own.link_position(theta, felt[joint]))
                });
                let contact = believed.gravity(&q) - felt;
                let singularity = self.arm.estimator.singularity;
                let force = kinematics.tip_force(&q, &contact, singularity);
                let pushes = force.map_or(0.0, |force| force.dot(&edge.normal));
                for _ in 0..ROUNDS {
                    let (tip, jacobian) = kinematics.forward_and_jacobian(&q);
                    let off = edge.distance(&tip) + pushes / edge.contact.stiffness;
                    let lever = edge.normal.dot(&jacobian.column(1));
                    if lever.abs() > 1e-6 {
                        q.y -= off / lever;
                    }
                }
                q.y
            })
            .collect()
    }
}
