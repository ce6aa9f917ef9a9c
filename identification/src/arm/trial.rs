//! Effects of the arm, tried on all joints together.

use std::collections::BTreeMap;

use nalgebra::DMatrix;

use super::effects::ArmEffect;
use super::prepared::PreparedArm;
use super::shared::{self, SharedFit, weighted_decrease};
use crate::diagnosis::dependence::one_sided;
use crate::fit::Parameter;
use crate::validation::left_out::Decrease;
use crate::validation::{Score, gain_of_folds};

/// Rounds in which an effect is linearised again.
const ROUNDS: usize = 3;
/// Smallest share of the weighted mean square that an effect of the arm explains.
const MIN_SHARE: f64 = 0.02;
/// Smallest of them, linearised where it is nothing, for it to be linearised again.
const MIN_PROMISE: f64 = 0.005;
/// Smallest certainty of its prediction of rows left out, in standard errors.
const MIN_CERTAINTY: f64 = 3.0;
/// Probability of a false alarm over all that are tried.
const SIGNIFICANCE: f64 = 0.01;

/// One effect of the arm at its best coefficients.
pub(super) struct Tried {
    pub(super) effect: ArmEffect,
    value: Vec<f64>,
    covariance: DMatrix<f64>,
    score: Score,
    fit: SharedFit,
    /// How much lower each joint's error on rows left out is.
    pub(super) decreases: Vec<Decrease>,
    /// How many were tried with it.
    tried: usize,
}

/// Tries every effect of the arm that the model lacks; `before` is the model as it is.
pub(super) fn try_all(
    arm: &PreparedArm<'_>,
    before: &SharedFit,
    progress: &mut dyn FnMut(f64),
) -> Vec<Tried> {
    let all = ArmEffect::all(arm.joints.len());
    let has = |effect: &ArmEffect| arm.corrections.iter().any(|own| own.effect == *effect);
    let missing: Vec<ArmEffect> = all.into_iter().filter(|effect| !has(effect)).collect();
    let count = missing.len();
    let each = missing.into_iter().enumerate().map(|(done, effect)| {
        let tried = try_one(arm, effect, before, count);
        progress((done + 1) as f64 / count.max(1) as f64);
        tried
    });
    each.collect()
}

/// Fits one effect beside those of the model.
pub(super) fn try_one(
    arm: &PreparedArm<'_>,
    effect: ArmEffect,
    before: &SharedFit,
    tried: usize,
) -> Tried {
    let mut effects = arm.effects();
    let known: usize = effects.iter().map(|(effect, _)| effect.columns()).sum();
    effects.push((effect, vec![0.0; effect.columns()]));
    let rounds = match effect {
        ArmEffect::LinkInertia(_) => 1,
        _ => ROUNDS,
    };
    let mut weights: Vec<f64> = weights_of(&before.held_out());
    let mut columns = arm.columns(&effects);
    let mut fit = shared::fit(&arm.joints, &columns, &weights);
    let own = |fit: &SharedFit| fit.shared.rows(known, effect.columns()).into_owned();
    for _ in 1..rounds {
        let [share, _] = weighted_decrease(&fit.decreases_from(before), &weights).share();
        if share < MIN_PROMISE {
            break;
        }
        // The derivatives half-way make the chord right to second order.
        let half = own(&fit) * 0.5;
        if let Some((_, value)) = effects.last_mut() {
            *value = half.as_slice().to_vec();
        }
        // Joints by what is left with the effect.
        weights = weights_of(&fit.held_out());
        columns = arm.columns(&effects);
        fit = shared::fit(&arm.joints, &columns, &weights);
    }
    let folds = arm
        .joints
        .first()
        .map_or(&[][..], |joint| &joint.design.folds);
    let score = gain_of_folds(folds, &columns.reduced(&arm.joints, &weights, known));
    let size = effect.columns();
    Tried {
        effect,
        value: own(&fit).as_slice().to_vec(),
        covariance: fit
            .covariance
            .view((known, known), (size, size))
            .into_owned(),
        decreases: fit.decreases_from(before),
        score,
        fit,
        tried,
    }
}

/// One over mean squares.
pub(super) fn weights_of(errors: &[f64]) -> Vec<f64> {
    errors.iter().map(|e| e.max(1e-12).powi(-2)).collect()
}

impl Tried {
    /// p-value of its prediction of rows left out, corrected for all that were tried.
    pub(super) fn p_value(&self) -> f64 {
        let p_value = one_sided(self.score.certainty, self.score.gains.len());
        (p_value * self.tried.max(1) as f64).min(1.0)
    }

    /// RMS on rows left out with it, of each joint \[Nm\].
    pub(super) fn held_out(&self) -> Vec<f64> {
        self.fit.held_out()
    }

    /// Whether it lowers the error of the joints together for certain, and without the
    /// joint that it helps most, too: else it is no more than an effect of that joint.
    pub(super) fn passes(&self, weights: &[f64]) -> bool {
        let all = weighted_decrease(&self.decreases, weights);
        let [share, _] = all.share();
        let is_seen = self.score.certainty > MIN_CERTAINTY && self.p_value() < SIGNIFICANCE;
        all.is_certain() && share > MIN_SHARE && is_seen && self.is_of_several(weights)
    }

    fn is_of_several(&self, weights: &[f64]) -> bool {
        let gain = |at: &usize| self.decreases[*at].mean_square * weights[*at];
        let most = (0..self.decreases.len()).max_by(|a, b| gain(a).total_cmp(&gain(b)));
        let Some(most) = most.filter(|_| self.decreases.len() > 1) else {
            return true;
        };
        let mut others = weights.to_vec();
        others[most] = 0.0;
        weighted_decrease(&self.decreases, &others).is_certain()
    }

    /// Its parameters with standard errors.
    pub(super) fn parameters(&self, arm: &PreparedArm<'_>) -> BTreeMap<String, Parameter> {
        parameters(
            arm,
            self.effect,
            &self.value,
            (&self.covariance, self.fit.freedom),
        )
    }
}

/// Parameters of an effect of the arm as reported; its covariance has so many degrees of
/// `freedom`.
pub(super) fn parameters(
    arm: &PreparedArm<'_>,
    effect: ArmEffect,
    value: &[f64],
    (covariance, freedom): (&DMatrix<f64>, f64),
) -> BTreeMap<String, Parameter> {
    let each = effect
        .reported(|at| arm.joint_named(at), value, covariance)
        .into_iter();
    each.map(|(name, unit, value, error)| {
        let parameter = Parameter::measured(value, (error, freedom), unit, effect.id());
        (name, parameter)
    })
    .collect()
}
