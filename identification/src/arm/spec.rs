//! The model of an arm that is believed.

use ferntast_model::rigid_body::{Chain, Vector3};

use super::data::ArmDataset;
use super::effects::ArmEffect;
use super::error::ArmError;
use super::term::ArmTerm;
use crate::data::{Inertia, JointType, ModelSpec};

/// The believed model of an arm.
#[derive(Clone, Debug)]
pub struct ArmSpec {
    /// Joints and links; its armatures do not count.
    pub chain: Chain,
    /// Gravity in the base frame \[m/s²\].
    pub gravity: Vector3<f64>,
    /// Inertia of motor and gear of each joint \[kg m²\] or \[kg\].
    pub armature: Vec<Inertia>,
    /// Gear ratio of each joint, where it is known.
    pub gear_ratio: Vec<Option<f64>>,
    /// Its effects.
    pub effects: Vec<ArmTerm>,
}

impl ArmSpec {
    /// Kind of joint number `at`.
    #[must_use]
    pub fn joint_type(&self, at: usize) -> JointType {
        let kind = self.chain.kinds().get(at).copied();
        kind.map(JointType::from).unwrap_or_default()
    }

    /// The effects of the arm, as they are in the model.
    pub(super) fn arm_effects(&self, joints: &[String]) -> Result<Vec<ArmEffect>, ArmError> {
        let mut all = Vec::new();
        for term in &self.effects {
            if let Some(effect) = ArmEffect::of(term, joints)? {
                if all.contains(&effect) {
                    return Err(ArmError::Twice(term.to_string()));
                }
                all.push(effect);
            }
        }
        Ok(all)
    }

    /// The model of one joint: the effects that are every joint's, and its own.
    pub(super) fn of_joint(&self, at: usize, joints: &[String]) -> Result<ModelSpec, ArmError> {
        let mut effects = Vec::new();
        for term in &self.effects {
            if let Some(joint) = &term.joint
                && !joints.contains(joint)
            {
                return Err(ArmError::UnknownJoint {
                    effect: term.effect.name().to_owned(),
                    joint: joint.clone(),
                    known: joints.join(", "),
                });
            }
            let own = term
                .joint
                .as_ref()
                .is_none_or(|name| joints.get(at) == Some(name));
            if own && ArmEffect::of(term, joints)?.is_none() {
                effects.push(term.effect.clone());
            }
        }
        Ok(ModelSpec {
            inertia: self
                .armature
                .get(at)
                .copied()
                .unwrap_or(Inertia::Given(0.0)),
            gear_ratio: self.gear_ratio.get(at).copied().flatten(),
            effects,
        })
    }

    /// That there is one of everything for each joint.
    pub(super) fn check(&self, dataset: &ArmDataset) -> Result<(), ArmError> {
        let joints = dataset.joints.len();
        let mut counts = vec![
            ("joints of the chain".to_owned(), self.chain.count().get()),
            ("armatures".to_owned(), self.armature.len()),
            ("gear ratios".to_owned(), self.gear_ratio.len()),
        ];
        for session in dataset.sessions.iter().chain(&dataset.held_out) {
            let of = |what: &str| format!("{what} of {}", session.name);
            counts.push((of("positions"), session.position.len()));
            counts.push((of("motor torques"), session.motor_torque.len()));
        }
        match counts.into_iter().find(|(_, found)| *found != joints) {
            Some((what, found)) => Err(ArmError::Count {
                what,
                found,
                joints,
            }),
            None => Ok(()),
        }
    }
}
