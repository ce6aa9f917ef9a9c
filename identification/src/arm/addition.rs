//! An arm's model with one more effect.

use std::collections::BTreeMap;

use serde::Serialize;

use super::comparison::{fit, name_partner, of_arm};
use super::data::ArmDataset;
use super::error::ArmError;
use super::prepared::PreparedArm;
use super::shared::weighted_decrease;
use super::soft_gears::moves_links;
use super::spec::ArmSpec;
use super::term::ArmTerm;
use super::trial::weights_of;
use crate::fit::Parameter;
use crate::validation::left_out::Decrease;

/// Errors and parameters without and with one more effect.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ArmAddition {
    /// The effect.
    pub effect: String,
    /// Its joint, where it is one of a joint or a link.
    pub joint: Option<String>,
    /// RMS on rows left out, before \[Nm\]: of its joint, else of all joints, each weighted
    /// by its noise.
    pub held_out_before: f64,
    /// The same after \[Nm\].
    pub held_out_after: f64,
    /// As mean squares, with the uncertainty of their difference.
    pub decrease: Decrease,
    /// Whether the error on rows left out falls by more than its own uncertainty; that of all
    /// joints together, too, where the effect moves links that others feel.
    pub lowers_error: bool,
    /// All parameters of the new model, by `parameter@joint`, of the arm by
    /// `effect.parameter`.
    pub parameters: BTreeMap<String, Parameter>,
    /// Those that the data do not excite.
    pub not_excited: Vec<String>,
    /// Effects whose free fit is no body that can exist: they are at the nearest that can.
    pub held_possible: Vec<String>,
}

/// Fits the model without and with one more effect.
///
/// # Errors
///
/// See [`ArmError`].
pub fn add(dataset: &ArmDataset, spec: &ArmSpec, term: &ArmTerm) -> Result<ArmAddition, ArmError> {
    if spec.effects.contains(term) {
        return Err(ArmError::Twice(term.to_string()));
    }
    let mut more = spec.clone();
    more.effects.push(term.clone());
    let before = PreparedArm::new(dataset, spec)?;
    let after = PreparedArm::new(dataset, &more)?;
    let then = fit(&after);
    let of_arm_before = before.corrections.len();
    // Both on the rows that the new model is fitted to.
    let same = before.on_rows_of(&after);
    let decreases = then.decreases_from(&fit(&same));
    let of_joint = match &term.joint {
        Some(joint) if of_arm_before == after.corrections.len() => {
            dataset.joints.iter().position(|name| name == joint)
        }
        _ => None,
    };
    let of_all = weighted_decrease(&decreases, &weights_of(&then.held_out()));
    let decrease = match of_joint.and_then(|at| decreases.get(at)) {
        Some(own) => *own,
        None => of_all,
    };
    let (parameters, not_excited) = parameters(&after);
    Ok(ArmAddition {
        effect: term.effect.name().to_owned(),
        joint: term.joint.clone(),
        held_out_before: decrease.before,
        held_out_after: decrease.after,
        lowers_error: decrease.is_certain() && (!moves_links(&term.effect) || of_all.is_certain()),
        decrease,
        parameters,
        not_excited,
        held_possible: after.held_possible(),
    })
}

/// All parameters of an arm's model by name, and those that the data do not excite.
pub(super) fn parameters(arm: &PreparedArm<'_>) -> (BTreeMap<String, Parameter>, Vec<String>) {
    let (mut all, mut not_excited) = (BTreeMap::new(), Vec::new());
    for joint in &arm.joints {
        let mut fitted = crate::fit::fit(&joint.prepared, &joint.design);
        name_partner(&mut fitted.parameters, joint);
        let at = |name: &str| format!("{name}@{}", joint.name);
        let known = &fitted.parameters;
        let named = fitted
            .not_excited
            .iter()
            .filter(|name| known.contains_key(*name));
        not_excited.extend(named.map(|name| at(name)));
        all.extend(
            fitted
                .parameters
                .iter()
                .map(|(name, own)| (at(name), own.clone())),
        );
    }
    for (effect, parameters) in of_arm(arm) {
        for (name, own) in parameters {
            let name = format!("{effect}.{name}");
            if own.std_error.is_some_and(|error| error >= own.value.abs()) {
                not_excited.push(name.clone());
            }
            all.insert(name, own);
        }
    }
    (all, not_excited)
}

impl PreparedArm<'_> {
    /// The same model on the rows of `other`, which is bound to the same recordings.
    pub(super) fn on_rows_of(mut self, other: &Self) -> Self {
        let each = self.joints.into_iter().zip(&other.joints);
        self.joints = each.map(|(own, theirs)| own.on_rows_of(theirs)).collect();
        self
    }
}
