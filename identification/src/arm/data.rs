//! What is known of an arm: recordings of all its joints, and the model that is believed.

use std::{collections::BTreeMap, fmt};

use ferntast_model::rigid_body::{Chain, Vector3};

use super::effects::ArmEffect;
use crate::data::error::PrepareError;
use crate::data::stated_filter::StatedFilter;
use crate::data::{CustomEffect, Inertia, JointType, ModelSpec, Term};

/// One session of all joints, sampled together at a uniform period.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ArmSession {
    /// Origin, in words.
    pub name: String,
    /// Start \[s\] since the first session's start.
    pub start: f64,
    /// Sampling period \[s\].
    pub period: f64,
    /// q of each joint \[rad\] or \[m\].
    pub position: Vec<Vec<f64>>,
    /// τ_m of each joint, on the joint side of the gear \[Nm\] or \[N\].
    pub motor_torque: Vec<Vec<f64>>,
    /// Conditions that stay as they are during the session, by name.
    pub conditions: BTreeMap<String, f64>,
}

/// The recordings of an arm.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ArmDataset {
    /// Names of the joints, from the base on.
    pub joints: Vec<String>,
    /// What the model is fitted to.
    pub sessions: Vec<ArmSession>,
    /// Never fitted, only predicted; may be empty.
    pub held_out: Vec<ArmSession>,
    /// Filters stated by the user; `None`: chosen from the noise, joint by joint.
    pub filter: Option<StatedFilter>,
}

/// An effect of an arm's model.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmTerm {
    /// The effect, of a joint or of the arm.
    pub effect: Term,
    /// Name of its joint; `None`: every joint, or the arm.
    pub joint: Option<String>,
}

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

/// Why an arm's model cannot be bound to recordings.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ArmError {
    /// It is so with one joint.
    #[error("{joint}: {source}")]
    Joint {
        /// Its name.
        joint: String,
        /// What is wrong.
        source: Box<PrepareError>,
    },
    /// Recordings or model have not one of each for each joint.
    #[error("{what}: {found} where the arm has {joints} joints; give one for each")]
    Count {
        /// Of what.
        what: String,
        /// So many.
        found: usize,
        /// As many as are needed.
        joints: usize,
    },
    /// An effect of a joint that is not there.
    #[error("{effect}@{joint}: the arm has no such joint; its joints are {known}")]
    UnknownJoint {
        /// The effect.
        effect: String,
        /// The joint that is named.
        joint: String,
        /// Joints that there are.
        known: String,
    },
    /// An effect of the arm with a joint, or one of a link without.
    #[error("{effect}: {reason}")]
    Place {
        /// The effect.
        effect: String,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// The same effect is there already.
    #[error("{0} is in the model already")]
    Twice(String),
}

impl ArmTerm {
    /// Of a name as it is written in files: `payload`, `stribeck@elbow`.
    #[must_use]
    pub fn parse(text: &str) -> Self {
        let (id, joint) = split(text);
        Self {
            effect: Term::Catalogue(id.to_owned()),
            joint: joint.map(str::to_owned),
        }
    }

    /// The same of a formula of the user's own, whose name may say the joint.
    #[must_use]
    pub fn of(term: &Term) -> Self {
        match term {
            Term::Catalogue(text) => Self::parse(text),
            Term::Custom(custom) => {
                let (name, joint) = split(&custom.name);
                let (name, joint) = (name.to_owned(), joint.map(str::to_owned));
                let mut custom = custom.clone();
                custom.name = name;
                Self {
                    effect: Term::Custom(custom),
                    joint,
                }
            }
        }
    }

    /// As it is written in files: what [`of`](Self::of) reads.
    #[must_use]
    pub fn written(&self) -> Term {
        match &self.effect {
            Term::Catalogue(_) => Term::Catalogue(self.to_string()),
            Term::Custom(own) => Term::Custom(CustomEffect {
                name: self.to_string(),
                ..own.clone()
            }),
        }
    }
}

fn split(text: &str) -> (&str, Option<&str>) {
    match text.split_once('@') {
        Some((name, joint)) => (name.trim(), Some(joint.trim())),
        None => (text.trim(), None),
    }
}

impl fmt::Display for ArmTerm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.joint {
            Some(joint) => write!(f, "{}@{joint}", self.effect.name()),
            None => f.write_str(self.effect.name()),
        }
    }
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
