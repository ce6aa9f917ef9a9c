//! An arm's model bound to recordings: one model a joint, and the effects of the arm with
//! the coefficients reached.

use std::collections::BTreeMap;

use ferntast_model::rigid_body::LinkInertia;
use nalgebra::{DMatrix, DVector};

use super::data::ArmDataset;
use super::effects::ArmEffect;
use super::error::ArmError;
use super::joint::ArmJoint;
use super::motion::{Motion, States};
use super::possible::{nearest_link, nearest_payload};
use super::rigid_body::RigidBody;
use super::shared::{self, ArmColumns};
use super::soft_gears::{TurnedInertias, Winding, moves_links};
use super::spec::ArmSpec;
use super::term::ArmTerm;
use crate::data::stated_filter::StatedFilter;
use crate::data::{Dataset, JointType, RecordedSession};
use crate::effects::{LOAD_OF, POSITION_OF, VELOCITY_OF};
use crate::numerics::gram::pseudo_inverse;
use crate::preparation::prepare;

/// Fits of the effects of the arm, at most, …
const MAX_FITS: usize = 5;
/// … and none after one that moves no coefficient by this share of itself and of its
/// standard error.
const MIN_STEP: f64 = 0.01;

/// An effect of the arm that is in the model, with its coefficients.
#[derive(Clone)]
pub(super) struct Correction {
    pub(super) effect: ArmEffect,
    pub(super) value: Vec<f64>,
    /// By folds left out of the free fit.
    pub(super) covariance: DMatrix<f64>,
    /// Whether the free fit is no body that can exist: then it is at the nearest that can,
    /// and counts as known.
    pub(super) is_held: bool,
}

/// A model bound to the recordings of an arm.
pub struct PreparedArm<'a> {
    /// From the base on.
    pub joints: Vec<ArmJoint>,
    pub(super) spec: &'a ArmSpec,
    pub(super) motion: Motion,
    inertias: TurnedInertias,
    pub(super) corrections: Vec<Correction>,
}

impl<'a> PreparedArm<'a> {
    /// Binds the model `spec` to `dataset`.
    ///
    /// # Errors
    ///
    /// [`ArmError`]: what recordings or model lack.
    pub fn new(dataset: &ArmDataset, spec: &'a ArmSpec) -> Result<Self, ArmError> {
        spec.check(dataset)?;
        let corrections = spec.arm_effects(&dataset.joints)?.into_iter();
        let corrections = corrections.map(|effect| Correction {
            effect,
            value: vec![0.0; effect.columns()],
            covariance: DMatrix::zeros(effect.columns(), effect.columns()),
            is_held: false,
        });
        let motion = Motion::new(dataset, |joint| spec.joint_type(joint));
        let mut arm = Self {
            joints: Vec::new(),
            spec,
            inertias: TurnedInertias::new(&spec.chain, &motion.states),
            motion,
            corrections: corrections.collect(),
        };
        arm.bind(&dataset.joints, dataset.filter)?;
        for _ in 0..MAX_FITS {
            if arm.corrections.is_empty() || arm.step() < MIN_STEP {
                break;
            }
            arm.bind(&dataset.joints, dataset.filter)?;
        }
        Ok(arm)
    }

    /// Links and gravity with all corrections.
    pub(super) fn body(&self) -> RigidBody<'a> {
        let mut body = RigidBody::new(&self.spec.chain, self.spec.gravity);
        for own in &self.corrections {
            own.effect.apply(&mut body, &own.value);
        }
        body
    }

    /// The same without one effect.
    pub(super) fn body_without(&self, effect: ArmEffect) -> RigidBody<'a> {
        let mut body = RigidBody::new(&self.spec.chain, self.spec.gravity);
        for own in self.corrections.iter().filter(|own| own.effect != effect) {
            own.effect.apply(&mut body, &own.value);
        }
        body
    }

    /// Makes every joint's recordings and binds its model to them.
    fn bind(&mut self, names: &[String], filter: Option<StatedFilter>) -> Result<(), ArmError> {
        let torques = self.torques(&self.motion.states);
        let windings = self.windings(names, filter, &torques)?;
        self.joints = if windings.is_empty() {
            let joints = 0..names.len();
            let joints = joints.map(|at| self.joint_of(at, names, filter, &torques));
            joints.collect::<Result<_, _>>()?
        } else {
            self.joints_behind(&windings, names, filter)?
        };
        Ok(())
    }

    /// How far gears that are soft in the models of their joints are wound up, where the links take
    /// these torques.
    fn windings(
        &self,
        names: &[String],
        filter: Option<StatedFilter>,
        torques: &[Vec<Vec<f64>>],
    ) -> Result<Vec<Winding>, ArmError> {
        let mut windings = Vec::new();
        for at in 0..names.len() {
            if (self.spec.of_joint(at, names)?.effects.iter()).any(moves_links) {
                let joint = self.joint_of(at, names, filter, torques)?;
                windings.extend(self.inertias.winding(at, &joint));
            }
        }
        Ok(windings)
    }

    /// Every joint, with the links behind soft gears where these have wound up to.
    fn joints_behind(
        &self,
        windings: &[Winding],
        names: &[String],
        filter: Option<StatedFilter>,
    ) -> Result<Vec<ArmJoint>, ArmError> {
        let behind = self.motion.states_behind(windings);
        let torques = self.torques(&behind);
        let joint = |at: usize| {
            let is_soft = windings.iter().any(|own| own.joint == at);
            if !is_soft {
                return self.joint_of(at, names, filter, &torques);
            }
            // Moved with the motor from where the links are: what winds the gear up.
            let each = behind.iter().cloned().zip(&self.motion.states);
            let moved = each.map(|(links, motors)| links.with_motion_of(at, motors));
            let torques = self.torques(&moved.collect::<Vec<_>>());
            self.joint_of(at, names, filter, &torques)
        };
        (0..names.len()).map(joint).collect()
    }

    /// τ of each joint at every sample, by session.
    fn torques(&self, states: &[States]) -> Vec<Vec<Vec<f64>>> {
        let body = self.body();
        states.iter().map(|states| body.torques(states)).collect()
    }

    /// Joint number `at`, its model bound to recordings with these torques of the links.
    fn joint_of(
        &self,
        at: usize,
        names: &[String],
        filter: Option<StatedFilter>,
        torques: &[Vec<Vec<f64>>],
    ) -> Result<ArmJoint, ArmError> {
        let name = names[at].clone();
        let dataset = self.dataset_of(at, names, filter, torques);
        let spec = self.spec.of_joint(at, names)?;
        match prepare(&dataset, &spec) {
            Ok(prepared) => Ok(ArmJoint::new(name, dataset, spec, prepared)),
            Err(source) => Err(ArmError::Joint {
                joint: name,
                source: Box::new(source),
            }),
        }
    }

    fn dataset_of(
        &self,
        joint: usize,
        names: &[String],
        filter: Option<StatedFilter>,
        torques: &[Vec<Vec<f64>>],
    ) -> Dataset {
        let each = self.motion.sessions.iter().zip(&self.motion.states);
        let each = each.zip(torques).enumerate();
        let mut sessions = each.map(|(number, ((session, states), torques))| {
            let mut extra = BTreeMap::new();
            for (other, name) in names
                .iter()
                .enumerate()
                .filter(|(other, _)| *other != joint)
            {
                let position = session.position.get(other).cloned().unwrap_or_default();
                extra.insert(format!("{POSITION_OF}{name}"), position);
                let velocity = states.qd.iter().map(|own| own[other]).collect();
                extra.insert(format!("{VELOCITY_OF}{name}"), velocity);
                extra.insert(format!("{LOAD_OF}{name}"), torques[other].clone());
            }
            RecordedSession {
                name: session.name.clone(),
                start: session.start,
                into_recording: session.into_recording,
                period: session.period,
                position: session.position[joint].clone(),
                motor_torque: session.motor_torque[joint].clone(),
                joint_torque: torques.get(joint).cloned(),
                torque_is_of_links: true,
                relative_links_inertia: (self.inertias.relative(number, joint))
                    .map(<[f64]>::to_vec),
                extra,
                conditions: session.conditions.clone(),
                ..RecordedSession::default()
            }
        });
        Dataset {
            sessions: sessions.by_ref().take(self.motion.fitted).collect(),
            held_out: sessions.collect(),
            joint: self.spec.joint_type(joint),
            filter,
        }
    }

    /// One over the mean square of each joint's error on rows left out \[1/Nm²\].
    pub(super) fn weights(&self) -> Vec<f64> {
        let each = self.joints.iter().map(|joint| joint.held_out);
        each.map(|error| error.max(1e-12).powi(-2)).collect()
    }

    /// Effects of the arm that are free, with the coefficients reached.
    pub(super) fn effects(&self) -> Vec<(ArmEffect, Vec<f64>)> {
        let free = self.corrections.iter().filter(|own| !own.is_held);
        free.map(|own| (own.effect, own.value.clone())).collect()
    }

    /// Columns of `effects`, each linearised around coefficients.
    pub(super) fn columns(&self, effects: &[(ArmEffect, Vec<f64>)]) -> ArmColumns {
        let without = |effect| self.body_without(effect);
        ArmColumns::new(&self.joints, &self.motion, effects, without)
    }

    /// Name and kind of joint number `at`.
    pub(super) fn joint_named(&self, at: usize) -> (String, JointType) {
        let name = self.joints.get(at).map(|own| own.name.clone());
        (name.unwrap_or_default(), self.spec.joint_type(at))
    }

    /// The effect as it is named in files.
    pub(super) fn term(&self, effect: ArmEffect) -> ArmTerm {
        effect.term(|at| self.joints.get(at).map(|joint| &joint.name))
    }

    /// Effects whose free fit is no body that can exist.
    pub(super) fn held_possible(&self) -> Vec<String> {
        let held = self.corrections.iter().filter(|own| own.is_held);
        held.map(|own| self.term(own.effect).to_string()).collect()
    }

    /// One Gauss-Newton step of the corrections; the largest change, as a share of the
    /// coefficient and its standard error.
    fn step(&mut self) -> f64 {
        let before: Vec<(ArmEffect, Vec<f64>)> = (self.corrections.iter())
            .map(|own| (own.effect, own.value.clone()))
            .collect();
        let columns = self.columns(&before);
        let fitted = shared::fit(&self.joints, &columns, &self.weights());
        let mut at = 0;
        for own in &mut self.corrections {
            let count = own.value.len();
            let covariance = fitted.covariance.view((at, at), (count, count));
            own.covariance = covariance.into_owned();
            own.is_held = false;
            let steps = fitted.shared.rows(at, count);
            let each = own.value.iter_mut().zip(steps.iter());
            each.for_each(|(value, step)| *value += step);
            at += count;
        }
        self.hold_possible(&fitted.normal);
        let mut largest = 0.0;
        for (own, (_, before)) in self.corrections.iter().zip(&before) {
            for (k, (value, before)) in own.value.iter().zip(before).enumerate() {
                let error = own.covariance[(k, k)].max(0.0).sqrt();
                let size = (value.abs() + error).max(1e-300);
                largest = f64::max(largest, (value - before).abs() / size);
            }
        }
        largest
    }

    /// Moves each effect that leaves no body that can exist to the nearest that does, by the
    /// `normal` equations of all coefficients, and the others along.
    fn hold_possible(&mut self, normal: &DMatrix<f64>) {
        let mut at = 0;
        for number in 0..self.corrections.len() {
            let (effect, count) = {
                let own = &self.corrections[number];
                (own.effect, own.value.len())
            };
            let first = at;
            at += count;
            let link = match effect {
                ArmEffect::BaseTilt | ArmEffect::JointZero(_) | ArmEffect::JointZeros(_) => {
                    continue;
                }
                ArmEffect::Payload => self.joints.len().saturating_sub(1),
                ArmEffect::LinkInertia(link) => link,
            };
            if self.body().link(link).is_physical() {
                continue;
            }
            let believed: LinkInertia = self.body_without(effect).link(link);
            if effect == ArmEffect::Payload && !believed.is_physical() {
                // What the URDF says of the link is at fault.
                continue;
            }
            let others: Vec<usize> = (0..normal.nrows())
                .filter(|own| !(first..first + count).contains(own))
                .collect();
            let along = of_the_others(normal, first, count, &others);
            let own = normal.view((first, first), (count, count)).into_owned();
            let cross =
                DMatrix::from_fn(count, others.len(), |i, j| normal[(first + i, others[j])]);
            let own = own + &cross * &along;
            let free = DVector::from_column_slice(&self.corrections[number].value);
            let held = match effect {
                ArmEffect::Payload => nearest_payload(&believed, &free, &own),
                _ => nearest_link(&believed, &free, &own),
            };
            let moved = along * (&held - &free);
            let correction = &mut self.corrections[number];
            correction.value = held.as_slice().to_vec();
            correction.is_held = true;
            let mut each = others.iter().zip(moved.iter()).peekable();
            let mut place = 0;
            for correction in &mut self.corrections {
                for value in &mut correction.value {
                    if let Some((_, moved)) = each.next_if(|(other, _)| **other == place) {
                        *value += moved;
                    }
                    place += 1;
                }
            }
        }
    }
}

/// How the other coefficients follow those from `first` on, one column each, where these
/// are moved from the least squares.
fn of_the_others(
    normal: &DMatrix<f64>,
    first: usize,
    count: usize,
    others: &[usize],
) -> DMatrix<f64> {
    let own = DMatrix::from_fn(others.len(), others.len(), |i, j| {
        normal[(others[i], others[j])]
    });
    let cross = DMatrix::from_fn(others.len(), count, |i, j| normal[(others[i], first + j)]);
    let (inverse, _) = pseudo_inverse(&own);
    -(inverse * cross)
}
