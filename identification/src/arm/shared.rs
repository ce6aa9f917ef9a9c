//! Coefficients that all joints share, fitted together with each joint's own.
//!
//! Least squares over the rows of all joints, each joint's divided by its noise. The
//! joints' own parameters are in no other joint's rows, so that they are eliminated
//! joint by joint (Schur complement) and the shared ones come from a small sum.

use nalgebra::{DMatrix, DVector};

use super::effects::ArmEffect;
use super::joint::ArmJoint;
use super::motion::Motion;
use super::rigid_body::RigidBody;
use crate::design::{BlockGrams, Design, SessionDesign};
use crate::numerics::gram::Gram;
use crate::numerics::statistics::jackknife_covariance;
use crate::signals::Signals;
use crate::validation::left_out::{Decrease, LeftOut};
use crate::validation::{fold_gram, reduced};

/// Blocks that are left out of a fit, by session and number.
type Fold = [(usize, usize)];

/// Columns of effects of the arm, filtered, on the rows of every joint: by joint,
/// session, column and row.
pub(super) struct ArmColumns {
    fitted: Vec<Vec<Vec<Vec<f64>>>>,
    held_out: Vec<Vec<Vec<Vec<f64>>>>,
    grams: Vec<BlockGrams>,
    count: usize,
}

impl ArmColumns {
    /// Of `effects`, each linearised around coefficients; `without` is the arm's body without one.
    pub(super) fn new<'a>(
        joints: &[ArmJoint],
        motion: &Motion,
        effects: &[(ArmEffect, Vec<f64>)],
        without: impl Fn(ArmEffect) -> RigidBody<'a>,
    ) -> Self {
        let count = effects.iter().map(|(effect, _)| effect.columns()).sum();
        let empty = |sessions: usize| vec![vec![Vec::with_capacity(count); sessions]; joints.len()];
        let fitted = motion.fitted;
        let mut columns = Self {
            fitted: empty(fitted),
            held_out: empty(motion.states.len() - fitted),
            grams: Vec::new(),
            count,
        };
        for (effect, value) in effects {
            let body = without(*effect);
            for (at, states) in motion.states.iter().enumerate() {
                let all = effect.derivatives(&body, value, states);
                for (number, (joint, own)) in joints.iter().zip(all).enumerate() {
                    let prepared = &joint.prepared;
                    let (signals, into) = match at.checked_sub(fitted) {
                        None => (prepared.sessions.get(at), &mut columns.fitted[number][at]),
                        Some(at) => (prepared.held_out.get(at), &mut columns.held_out[number][at]),
                    };
                    let filtered = |column: &Vec<f64>| {
                        signals.map_or_else(Vec::new, |signals: &Signals| {
                            signals.column.at_samples(column, &signals.rows)
                        })
                    };
                    into.extend(own.iter().map(filtered));
                }
            }
        }
        columns.grams = (joints.iter().zip(&columns.fitted))
            .map(|(joint, own)| joint.design.with(own))
            .collect();
        columns
    }

    /// Gram matrices of the shared columns and y, block by block, less what each
    /// session's own parameters of each joint explain of them; joints weighted, and
    /// less what the first `known` columns explain.
    pub(super) fn reduced(&self, joints: &[ArmJoint], weights: &[f64], known: usize) -> BlockGrams {
        let mut sum: BlockGrams = Vec::new();
        for ((joint, grams), weight) in joints.iter().zip(&self.grams).zip(weights) {
            let (own, _) = reduced(&joint.design, grams);
            for (s, session) in own.into_iter().enumerate() {
                if sum.len() <= s {
                    sum.push(Vec::new());
                }
                for (b, mut gram) in session.into_iter().enumerate() {
                    gram.products *= *weight;
                    match sum[s].get_mut(b) {
                        Some(sum) => sum.add(&gram),
                        None => sum[s].push(gram),
                    }
                }
            }
        }
        let total = Gram::sum(sum.iter().flatten(), self.count);
        let explained = total.explain_freely(known);
        for gram in sum.iter_mut().flatten() {
            *gram = gram.reduce(known, &explained);
        }
        sum
    }
}

/// Shared coefficients with each joint's own.
struct Solution {
    shared: DVector<f64>,
    own: Vec<DVector<f64>>,
    /// Products of the shared columns less what the joints' own explain of them.
    normal: DMatrix<f64>,
}

/// A fit of all joints together.
pub(super) struct SharedFit {
    /// Of the columns, in their order.
    pub(super) shared: DVector<f64>,
    pub(super) covariance: DMatrix<f64>,
    /// Normal equations of them, with the joints' own parameters taken out; weighted.
    pub(super) normal: DMatrix<f64>,
    /// Degrees of freedom of the covariance.
    pub(super) freedom: f64,
    /// Residuals on rows left out, of each joint.
    pub(super) left_out: Vec<LeftOut>,
    /// RMS on the rows fitted, of each joint \[Nm\].
    pub(super) train: Vec<f64>,
}

impl SharedFit {
    /// Root mean square on rows left out, of each joint \[Nm\].
    pub(super) fn held_out(&self) -> Vec<f64> {
        self.left_out.iter().map(LeftOut::rms).collect()
    }

    /// How much lower each joint's error is than `before`.
    pub(super) fn decreases_from(&self, before: &SharedFit) -> Vec<Decrease> {
        let both = self.left_out.iter().zip(&before.left_out);
        both.map(|(after, before)| after.decrease_from(before))
            .collect()
    }
}

/// Fits the shared columns together with all joints' own parameters; a joint's squares
/// are multiplied by its weight.
pub(super) fn fit(joints: &[ArmJoint], columns: &ArmColumns, weights: &[f64]) -> SharedFit {
    let solve = |fold: &Fold| solve(joints, columns, weights, fold);
    let all = solve(&[]);
    let folds = joints.first().map_or(&[][..], |joint| &joint.design.folds);
    let without: Vec<DVector<f64>> = folds.iter().map(|fold| solve(fold).shared).collect();
    let left_out = joints.iter().enumerate().map(|(number, joint)| {
        if !joint.prepared.held_out.is_empty() {
            return LeftOut::of_held_out(&joint.prepared, |at, session| {
                let extra = &columns.held_out[number][at];
                residual(session, extra, &all, number)
            });
        }
        LeftOut::of_folds_by(&joint.design, |fold| {
            let solution = solve(fold);
            move |at: usize, session: &SessionDesign| {
                residual(session, &columns.fitted[number][at], &solution, number)
            }
        })
    });
    SharedFit {
        left_out: left_out.collect(),
        train: (joints.iter().enumerate())
            .map(|(number, joint)| train(&joint.design, &columns.fitted[number], &all, number))
            .collect(),
        covariance: jackknife_covariance(&all.shared, &without),
        freedom: freedom(joints),
        normal: all.normal,
        shared: all.shared,
    }
}

/// Degrees of freedom of covariances: what is left out in turn, less one.
pub(super) fn freedom(joints: &[ArmJoint]) -> f64 {
    let folds = joints.first().map_or(0, |joint| joint.design.folds.len());
    (folds as f64 - 1.0).max(1.0)
}

/// Without the rows of a fold.
fn solve(joints: &[ArmJoint], columns: &ArmColumns, weights: &[f64], fold: &Fold) -> Solution {
    let mut sum = Gram::empty(columns.count);
    let mut explained = Vec::new();
    for ((joint, grams), weight) in joints.iter().zip(&columns.grams).zip(weights) {
        let base = joint.design.base;
        let width = base + columns.count;
        let total = Gram::sum(grams.iter().flatten(), width);
        let kept = total.without(&fold_gram(grams, fold, width));
        let own = kept.explain_freely(base);
        let mut reduced = kept.reduce(base, &own);
        reduced.products *= *weight;
        sum.add(&reduced);
        explained.push(own);
    }
    let shared = sum.solve();
    let own = explained
        .iter()
        .map(|own| own.column(columns.count) - own.columns(0, columns.count) * &shared);
    let own = own.collect();
    let count = columns.count;
    Solution {
        own,
        shared,
        normal: sum.products.view((0, 0), (count, count)).into_owned(),
    }
}

/// Measured less modelled of joint `number` \[Nm\].
fn residual(
    session: &SessionDesign,
    extra: &[Vec<f64>],
    solution: &Solution,
    number: usize,
) -> Vec<f64> {
    let mut residual = session.residual(&solution.own[number]);
    for (column, coefficient) in extra.iter().zip(solution.shared.iter()) {
        let each = residual.iter_mut().zip(column);
        each.for_each(|(residual, value)| *residual -= coefficient * value);
    }
    residual
}

fn train(design: &Design, extra: &[Vec<Vec<f64>>], solution: &Solution, number: usize) -> f64 {
    let (mut square, mut rows) = (0.0, 0_usize);
    for (session, extra) in design.sessions.iter().zip(extra) {
        let residual = residual(session, extra, solution, number);
        for (residual, judged) in residual.iter().zip(&session.judged) {
            if *judged {
                square += residual * residual;
                rows += 1;
            }
        }
    }
    (square / rows.max(1) as f64).sqrt()
}

/// The root mean square over joints, each weighted by its noise.
pub(super) fn weighted(errors: &[f64], weights: &[f64]) -> f64 {
    let sum: f64 = weights.iter().sum();
    let square: f64 = errors.iter().zip(weights).map(|(e, w)| w * e * e).sum();
    (square / sum.max(1e-300)).sqrt()
}

/// The decrease over all joints, each weighted by its noise.
pub(super) fn weighted_decrease(each: &[Decrease], weights: &[f64]) -> Decrease {
    let sum: f64 = weights.iter().sum::<f64>().max(1e-300);
    let of = |value: fn(&Decrease) -> f64| -> Vec<f64> { each.iter().map(value).collect() };
    let mean = |values: Vec<f64>| -> f64 {
        let each = values.iter().zip(weights).map(|(own, weight)| own * weight);
        each.sum::<f64>() / sum
    };
    let error = of(|own| own.std_error);
    let error = error.iter().zip(weights).map(|(own, w)| (own * w).powi(2));
    Decrease {
        before: weighted(&of(|own| own.before), weights),
        after: weighted(&of(|own| own.after), weights),
        mean_square: mean(of(|own| own.mean_square)),
        std_error: error.sum::<f64>().sqrt() / sum,
    }
}
