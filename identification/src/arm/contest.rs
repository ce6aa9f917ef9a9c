//! What explains the most of the whole arm: an effect of one joint, one of the arm, or
//! something in a joint that has no name.

use super::prepared::PreparedArm;
use super::shared::weighted_decrease;
use super::trial::Tried;
use crate::diagnosis::{Diagnosis, Verdict};

/// Two explain as much as each other where the ratio of their gains is above this.
const AS_GOOD: f64 = 0.85;
/// Effects of the arm leave as much as each other within this ratio.
const MAX_REMAINDER_RATIO: f64 = 1.05;
/// Smallest share of its gain that an effect of the arm has in other joints than the
/// one that it helps most, where that joint has an explanation of its own.
const MIN_ELSEWHERE: f64 = 0.2;

/// One of those that explain something.
#[derive(Clone, Copy)]
pub(super) enum Contender<'a> {
    /// An effect of the arm.
    Arm(&'a Tried),
    /// The first candidate of a joint.
    Joint(usize),
    /// What is left of a joint has no name.
    Unexplained,
}

/// All of them, with what they explain.
pub(super) struct Contest<'a> {
    /// One over the mean square of the noise of each joint \[1/Nm²\].
    pub(super) weights: Vec<f64>,
    /// With gains: decreases of the joints' mean squares over their noise.
    contenders: Vec<(Contender<'a>, f64)>,
    each: &'a [Diagnosis],
}

impl<'a> Contest<'a> {
    pub(super) fn new(arm: &PreparedArm<'_>, each: &'a [Diagnosis], tried: &'a [Tried]) -> Self {
        let weights = noise(arm, each, tried);
        let weights: Vec<f64> = weights.iter().map(|square| square.recip()).collect();
        let sum: f64 = weights.iter().sum();
        let mut contenders = Vec::new();
        for (at, own) in each.iter().enumerate() {
            let gain = explained(own) * weights[at];
            match (own.verdict, own.candidates.is_empty()) {
                (_, false) => contenders.push((Contender::Joint(at), gain)),
                (Verdict::Unexplained, true) => {
                    contenders.push((Contender::Unexplained, gain));
                }
                _ => {}
            }
        }
        for own in tried.iter().filter(|own| own.passes(&weights)) {
            let gain = weighted_decrease(&own.decreases, &weights).mean_square * sum;
            contenders.push((Contender::Arm(own), gain));
        }
        let mut contest = Self {
            weights,
            contenders,
            each,
        };
        contest.drop_what_one_joint_explains();
        contest
    }

    /// Leaves out the effects of the arm that do in one joint what an explanation of that
    /// joint does better, and next to nothing elsewhere.
    fn drop_what_one_joint_explains(&mut self) {
        let (each, weights) = (self.each, &self.weights);
        self.contenders.retain(|(contender, gain)| {
            let Contender::Arm(own) = contender else {
                return true;
            };
            let in_joint = |at: usize| own.decreases[at].mean_square * weights[at];
            let all = 0..own.decreases.len();
            let Some(most) = all.max_by(|a, b| in_joint(*a).total_cmp(&in_joint(*b))) else {
                return true;
            };
            let by_joint = explained(&each[most]) * weights[most];
            let elsewhere = gain - in_joint(most);
            by_joint < in_joint(most) || elsewhere > MIN_ELSEWHERE * gain
        });
    }

    /// What explains the most; of effects of the arm the simplest of those that explain
    /// as much.
    pub(super) fn winner(&self) -> Option<Contender<'a>> {
        let most = self.contenders.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let Contender::Arm(best) = most.0 else {
            return Some(most.0);
        };
        // The first of those that are as simple.
        let as_good = [best].into_iter().chain(self.alike(best));
        let simplest = as_good.min_by_key(|own| own.effect.columns());
        simplest.map(Contender::Arm)
    }

    /// Other effects of the arm that explain as much as one.
    pub(super) fn alike(&self, tried: &Tried) -> Vec<&'a Tried> {
        let of = |own: &Tried| weighted_decrease(&own.decreases, &self.weights);
        let best = of(tried);
        let arms = self.contenders.iter().filter_map(|(own, _)| match own {
            Contender::Arm(own) if own.effect != tried.effect => Some(*own),
            _ => None,
        });
        arms.filter(|own| {
            let other = of(own);
            other.mean_square > AS_GOOD * best.mean_square
                && other.after.powi(2) < MAX_REMAINDER_RATIO * best.after.powi(2)
        })
        .collect()
    }
}

/// Mean square that a joint's own explanation takes off its error \[Nm²\].
fn explained(own: &Diagnosis) -> f64 {
    let by_name = own
        .candidates
        .first()
        .map(|first| first.held_out_before.powi(2) - first.held_out_after.powi(2));
    let by_map = own.residual_depends_on.iter().map(|map| map.gain);
    match own.verdict {
        Verdict::Unexplained => by_map.fold(0.0, f64::max),
        Verdict::Missing | Verdict::Complete => by_name.unwrap_or(0.0),
    }
}

/// The least mean square that any of what was tried leaves of each joint \[Nm²\].
fn noise(arm: &PreparedArm<'_>, each: &[Diagnosis], tried: &[Tried]) -> Vec<f64> {
    let mut least: Vec<f64> = arm.joints.iter().map(|own| own.held_out.powi(2)).collect();
    for own in tried {
        for (least, error) in least.iter_mut().zip(own.held_out()) {
            *least = least.min(error * error);
        }
    }
    for (least, own) in least.iter_mut().zip(each) {
        for candidate in &own.candidates {
            *least = least.min(candidate.held_out_after.powi(2));
        }
        for map in &own.residual_depends_on {
            *least = least.min(own.rms.held_out.powi(2) * (1.0 - map.strength).max(0.05));
        }
        *least = least.max(1e-18);
    }
    least
}
