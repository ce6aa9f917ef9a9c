//! An arm's model against its recordings.

use std::collections::BTreeMap;

use serde::Serialize;

use super::data::{ArmDataset, ArmSession};
use super::error::ArmError;
use super::joint::ArmJoint;
use super::misread::{self, Misread};
use super::prepared::PreparedArm;
use super::shared::{self, SharedFit, weighted};
use super::spec::ArmSpec;
use super::trial::{self, weights_of};
use crate::comparison::{Comparison, VariesTogether, compare_prepared};
use crate::effects::{COUPLING, JointCoupling};
use crate::fit::{Parameter, Rms};

/// Points of a session that are drawn of each joint.
const MAX_DRAWN_POINTS: usize = 2000;

/// An arm's model against its recordings.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ArmComparison {
    /// Samples in the recordings, of each joint.
    pub samples: usize,
    /// Rows of the regressions of all joints.
    pub used: usize,
    /// Errors over all joints, each joint's mean square weighted by one over that of its
    /// residual \[Nm\].
    pub rms: Rms,
    /// Parameters of the effects of the arm, by `effect` or `effect@joint`.
    pub arm: BTreeMap<String, BTreeMap<String, Parameter>>,
    /// Those of them whose free fit is no body that can exist (negative mass, or an inertia
    /// that no shape has): they are at the nearest that can.
    pub held_possible: Vec<String>,
    /// Joints that are read otherwise than the model has them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub misread: Vec<Misread>,
    /// Signals and conditions that vary together from session to session.
    pub varies_together: Vec<VariesTogether>,
    /// Every joint.
    pub joints: BTreeMap<String, Comparison>,
}

/// Fits the model to all joints, and reports the error of each.
///
/// # Errors
///
/// See [`ArmError`].
pub fn compare(dataset: &ArmDataset, spec: &ArmSpec) -> Result<ArmComparison, ArmError> {
    let arm = PreparedArm::new(dataset, spec)?;
    let fit = fit(&arm);
    let joints: BTreeMap<String, Comparison> = (arm.joints.iter())
        .map(|joint| {
            let own = compare_prepared(&joint.dataset, &joint.prepared, MAX_DRAWN_POINTS);
            (joint.name.clone(), in_words(own, joint))
        })
        .collect();
    Ok(ArmComparison {
        samples: samples(dataset),
        used: used(&arm.joints),
        rms: rms(&fit),
        arm: of_arm(&arm),
        held_possible: arm.held_possible(),
        misread: misread::find(&arm),
        varies_together: varies_together(&arm.joints),
        joints,
    })
}

/// The model as it is, its effects of the arm fitted anew without each fold.
pub(super) fn fit(arm: &PreparedArm<'_>) -> SharedFit {
    let columns = arm.columns(&arm.effects());
    shared::fit(&arm.joints, &columns, &arm.weights())
}

/// What varies together in the sessions, which the joints have in common.
pub(super) fn varies_together(joints: &[ArmJoint]) -> Vec<VariesTogether> {
    let first = joints.first();
    first.map_or_else(Vec::new, |joint| {
        crate::comparison::varies_together::find(&joint.dataset)
    })
}

/// Samples of the sessions that are fitted.
pub(super) fn samples(dataset: &ArmDataset) -> usize {
    let length = |session: &ArmSession| session.position.first().map_or(0, Vec::len);
    dataset.sessions.iter().map(length).sum()
}

/// Rows of all joints.
pub(super) fn used(joints: &[ArmJoint]) -> usize {
    joints.iter().map(|joint| joint.design.total().rows).sum()
}

fn rms(fit: &SharedFit) -> Rms {
    let held_out = fit.held_out();
    let weights = weights_of(&held_out);
    Rms {
        train: weighted(&fit.train, &weights),
        held_out: weighted(&held_out, &weights),
    }
}

/// Parameters of the effects of the arm that are in the model.
pub(super) fn of_arm(arm: &PreparedArm<'_>) -> BTreeMap<String, BTreeMap<String, Parameter>> {
    let each = arm.corrections.iter().map(|own| {
        let name = arm.term(own.effect).to_string();
        let covariance = (&own.covariance, shared::freedom(&arm.joints));
        let parameters = trial::parameters(arm, own.effect, &own.value, covariance);
        (name, parameters)
    });
    each.collect()
}

/// With the coupling's parameters as they are to be read.
fn in_words(mut comparison: Comparison, joint: &ArmJoint) -> Comparison {
    name_partner(&mut comparison.parameters, joint);
    let known = &comparison.parameters;
    comparison
        .not_excited
        .retain(|name| known.contains_key(name));
    comparison
}

/// Of a coupling keeps the coefficients that it has, named after the joint that it comes
/// from, in place of that joint's number. Returns that joint.
pub(super) fn name_partner(
    parameters: &mut BTreeMap<String, Parameter>,
    joint: &ArmJoint,
) -> Option<String> {
    let own = |parameter: &Parameter| parameter.effect == COUPLING;
    let shape = ["from", "by"].map(|name| parameters.get(name).filter(|p| own(p)).map(|p| p.value));
    let [Some(from), Some(by)] = shape else {
        return None;
    };
    let coupling = JointCoupling::among(joint.dataset.sessions.first()?.extra.keys())?;
    let (partner, kept) = coupling.partner(&[from, by])?;
    for coefficient in kept {
        if let Some(parameter) = parameters.remove(coefficient.name) {
            parameters.insert(format!("{}_of_{partner}", coefficient.name), parameter);
        }
    }
    let named = format!("_of_{partner}");
    parameters.retain(|name, parameter| !own(parameter) || name.ends_with(&named));
    Some(partner.to_owned())
}
