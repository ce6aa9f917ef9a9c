//! Which effect is missing in an arm, in which of its joints or in the arm itself.
//!
//! Every joint is diagnosed by itself, and every effect of the arm is tried on all joints
//! together. What lowers the error of the whole arm most, each joint weighted by its
//! noise, comes first; the others are named only where they still pass with that in the
//! model.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use serde::Serialize;

use super::addition::add;
use super::comparison::{fit, name_partner, samples, used, varies_together};
use super::contest::{Contender, Contest};
use super::data::ArmDataset;
use super::effects::ArmEffect;
use super::error::ArmError;
use super::joint::ArmJoint;
use super::misread::{self, Misread};
use super::prepared::PreparedArm;
use super::shared::{SharedFit, weighted, weighted_decrease};
use super::soft_gears::moves_links;
use super::spec::ArmSpec;
use super::term::ArmTerm;
use super::trial::{Tried, try_all, try_one, weights_of};
use crate::comparison::{Usage, VariesTogether, noise_floor::NoiseFloor};
use crate::data::Term;
use crate::diagnosis::dependence::Dependence;
use crate::diagnosis::{self, Diagnosis, NamedCandidate, NotTested, Suspect, Verdict};
use crate::effects::LOAD_SHARE;
use crate::fit::Rms;
use ferntast_model::friction::Proposal;

/// Probability of a false alarm over all joints together.
const SIGNIFICANCE: f64 = 0.01;
/// Smallest share of a joint's mean square that a name explains: the links' torques are
/// those of smoothed motions, and not exact to the last percent of light joints' noise.
const MIN_SHARE: f64 = 0.025;
/// Share of the links' torque that winds a gear up: all, within what other errors make of it.
const WHOLE: RangeInclusive<f64> = 0.7..=1.3;
/// Share of the work that the first look at all joints is.
const FIRST_LOOK: f64 = 0.6;

/// An effect that passes all tests, of a joint or of the arm.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ArmCandidate {
    /// Its joint (of a link: the joint that carries it); `None` for one of the arm.
    pub joint: Option<String>,
    /// Of a coupling: the joint that it comes from.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub partner: Option<String>,
    /// The effect. Errors are those of its joint, of an effect of the arm those of
    /// all joints, each weighted by its noise.
    #[serde(flatten)]
    pub named: NamedCandidate,
}

impl ArmCandidate {
    /// As it is named in files.
    #[must_use]
    pub fn term(&self) -> ArmTerm {
        ArmTerm {
            effect: Term::Catalogue(self.named.effect.clone()),
            joint: self.joint.clone(),
        }
    }
}

/// An effect that is suspected in a joint.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ArmSuspect {
    /// The joint.
    pub joint: String,
    /// The effect.
    #[serde(flatten)]
    pub suspect: Suspect,
}

/// A dependence of a joint's residual. Signals of other joints are called
/// `position_NAME`, `velocity_NAME` and `load_NAME`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ArmDependence {
    /// The joint.
    pub joint: String,
    /// On what.
    #[serde(flatten)]
    pub dependence: Dependence,
}

/// How one joint fares.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct JointDiagnosis {
    /// Whether an effect is missing in this joint's torque, of its own or of the arm.
    pub verdict: Verdict,
    /// Its error \[Nm\].
    pub rms: Rms,
    /// RMS between repeats \[Nm\], where anything was repeated.
    pub noise_floor: Option<f64>,
    /// The same, and variation between sessions.
    pub noise: NoiseFloor,
    /// What became of its samples.
    pub used: Usage,
}

/// Result of a diagnosis of an arm.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ArmDiagnosis {
    /// Samples in the recordings, of each joint.
    pub samples: usize,
    /// Rows of the regressions of all joints.
    pub used: usize,
    /// Whether an effect is missing, and whether it is known.
    pub verdict: Verdict,
    /// Errors over all joints, each weighted by its noise \[Nm\].
    pub rms: Rms,
    /// Joints that are read otherwise than the model has them: then nothing is named, since anything
    /// may look as if it were missing.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub misread: Vec<Misread>,
    /// Effects that pass all tests, best first.
    pub candidates: Vec<ArmCandidate>,
    /// Effects that show between sessions, where nothing passes.
    pub suspected: Vec<ArmSuspect>,
    /// Signals on which residuals depend, strongest first.
    pub residual_depends_on: Vec<ArmDependence>,
    /// Signals and conditions that vary together from session to session: an effect of one
    /// cannot be told from an effect of the other.
    pub varies_together: Vec<VariesTogether>,
    /// Every joint.
    pub joints: BTreeMap<String, JointDiagnosis>,
    /// What these recordings cannot show of any joint, whatever the verdict: `not_tested`,
    /// `why_not_tested`.
    #[serde(flatten)]
    pub not_tested: NotTested,
    /// Effects and shapes tried.
    pub tried: usize,
}

/// Tries every effect that the model lacks, of every joint and of the arm.
///
/// `progress` is called with the share done, 0 … 1.
///
/// # Errors
///
/// See [`ArmError`].
pub fn diagnose(
    dataset: &ArmDataset,
    spec: &ArmSpec,
    progress: &mut dyn FnMut(f64),
) -> Result<ArmDiagnosis, ArmError> {
    let arm = PreparedArm::new(dataset, spec)?;
    let all: Vec<usize> = (0..arm.joints.len()).collect();
    let each = look(&arm, &all, &mut |done| progress(FIRST_LOOK * done))?;
    let before = fit(&arm);
    let misread = misread::find(&arm);
    if !misread.is_empty() {
        progress(1.0);
        let weights = weights_of(&before.held_out());
        let mut told = told_of(
            dataset,
            (&arm, &each),
            &vec![false; all.len()],
            (&before, &weights),
        );
        // What looks as if it were missing, or depended on something, is of the wrong reading.
        let joints = told.joints.values_mut();
        for own in joints.filter(|own| own.verdict == Verdict::Missing) {
            own.verdict = Verdict::Unexplained;
        }
        told.residual_depends_on.clear();
        return Ok(ArmDiagnosis {
            misread,
            verdict: Verdict::Unexplained,
            ..told
        });
    }
    let tried = try_all(&arm, &before, &mut |done| progress(FIRST_LOOK + 0.2 * done));
    let contest = Contest::new(&arm, &each, &tried);
    let weights = contest.weights.clone();
    let told = Told {
        arm: &arm,
        weights: &weights,
    };
    let mut candidates = Vec::new();
    let mut helped = vec![false; all.len()];
    let last = &mut |done| progress(FIRST_LOOK + 0.2 + 0.2 * done);
    match contest.winner() {
        Some(Contender::Arm(winner)) => {
            candidates.push(told.of_arm(winner, contest.alike(winner)));
            for (helped, decrease) in helped.iter_mut().zip(&winner.decreases) {
                *helped = decrease.is_certain();
            }
            let more = with(spec, arm.term(winner.effect));
            let then = PreparedArm::new(dataset, &more)?;
            candidates.extend(look_again(&told, &then, &each, &mut helped, last)?);
        }
        Some(Contender::Joint(winner)) => {
            let mut own = told.of_joint(winner, &each[winner]);
            let first = own.first().map(ArmCandidate::term);
            let more = first.map(|first| (moves_links(&first.effect), with(spec, first)));
            let passing: Vec<&Tried> = tried.iter().filter(|own| own.passes(&weights)).collect();
            match &more {
                Some((true, more)) => {
                    own.truncate(1);
                    candidates.append(&mut own);
                    let then = PreparedArm::new(dataset, more)?;
                    let mut left = look_again(&told, &then, &each, &mut helped, last)?;
                    // A second gear that is soft has to help the others, too.
                    left.retain(|own| {
                        !moves_links(&own.term().effect) || helps(dataset, more, own)
                    });
                    candidates.append(&mut left);
                }
                _ => {
                    candidates.append(&mut own);
                    let others = all.iter().filter(|at| **at != winner);
                    candidates.extend(others.flat_map(|at| told.of_joint(*at, &each[*at])));
                }
            }
            if let (Some((_, more)), false) = (&more, passing.is_empty()) {
                candidates.extend(still_passing(dataset, more, &passing, &weights, &told)?);
            }
        }
        Some(Contender::Unexplained) | None => {
            candidates.extend(all.iter().flat_map(|at| told.of_joint(*at, &each[*at])));
        }
    }
    progress(1.0);
    let told = told_of(dataset, (&arm, &each), &helped, (&before, &weights));
    let mut verdicts = told.joints.values().map(|own| own.verdict);
    Ok(match candidates.is_empty() {
        false => ArmDiagnosis {
            verdict: Verdict::Missing,
            candidates,
            tried: told.tried + tried.len(),
            ..told
        },
        true => ArmDiagnosis {
            verdict: match verdicts.any(|own| own == Verdict::Unexplained) {
                true => Verdict::Unexplained,
                false => Verdict::Complete,
            },
            suspected: suspected(&arm, &each),
            tried: told.tried + tried.len(),
            ..told
        },
    })
}

/// What is told of the joints, with nothing named or suspected: as `each` is by itself, and those
/// that what is named `helped`; `before` is the fit of the model, with the weights of the joints.
fn told_of(
    dataset: &ArmDataset,
    (arm, each): (&PreparedArm<'_>, &[Diagnosis]),
    helped: &[bool],
    (before, weights): (&SharedFit, &[f64]),
) -> ArmDiagnosis {
    ArmDiagnosis {
        samples: samples(dataset),
        used: used(&arm.joints),
        verdict: Verdict::Complete,
        rms: Rms {
            train: weighted(&before.train, weights),
            held_out: weighted(&before.held_out(), weights),
        },
        misread: Vec::new(),
        suspected: Vec::new(),
        candidates: Vec::new(),
        residual_depends_on: depends_on(arm, each),
        varies_together: varies_together(&arm.joints),
        joints: joints(arm, each, helped),
        // Every joint has the same sessions, and the links' torque for a load.
        not_tested: (each.first()).map_or_else(NotTested::default, |own| own.not_tested.clone()),
        tried: each.iter().map(|own| own.tried).sum(),
    }
}

/// Diagnoses these joints one by one.
fn look(
    arm: &PreparedArm<'_>,
    which: &[usize],
    progress: &mut dyn FnMut(f64),
) -> Result<Vec<Diagnosis>, ArmError> {
    let count = which.len().max(1) as f64;
    let each = which.iter().enumerate().map(|(done, at)| {
        let joint = &arm.joints[*at];
        let own = &mut |share: f64| progress((done as f64 + share) / count);
        let told = diagnosis::diagnose(&joint.dataset, &joint.spec, own);
        let told = told.map_err(|source| ArmError::Joint {
            joint: joint.name.clone(),
            source: Box::new(source),
        })?;
        Ok(corrected(told, arm.joints.len()))
    });
    each.collect()
}

/// Without what may be chance where so many joints are looked at (Bonferroni), and what
/// is too little to be told from the links' own error.
fn corrected(mut told: Diagnosis, joints: usize) -> Diagnosis {
    let is_certain = |p_value: f64| p_value * (joints as f64) < SIGNIFICANCE;
    (told.candidates)
        .retain(|own| is_certain(own.p_value) && own.share > MIN_SHARE && winds_up_whole(own));
    told.residual_depends_on
        .retain(|own| is_certain(own.p_value));
    let (named, left) = (&told.candidates, &told.residual_depends_on);
    told.verdict = match (told.verdict, named.is_empty(), left.is_empty()) {
        (Verdict::Missing, false, _) => Verdict::Missing,
        (Verdict::Missing | Verdict::Unexplained, _, false) => Verdict::Unexplained,
        _ => Verdict::Complete,
    };
    told
}

/// With what explains most in the model, `then`: what is left in the joints where something was
/// missing is a second effect, or nothing, and they were helped.
fn look_again(
    told: &Told<'_>,
    then: &PreparedArm<'_>,
    each: &[Diagnosis],
    helped: &mut [bool],
    progress: &mut dyn FnMut(f64),
) -> Result<Vec<ArmCandidate>, ArmError> {
    let open: Vec<usize> = (0..each.len())
        .filter(|at| each[*at].verdict != Verdict::Complete)
        .collect();
    let left = look(then, &open, progress)?;
    let mut candidates = Vec::new();
    for (at, left) in open.iter().zip(&left) {
        candidates.extend(told.of_joint(*at, left));
        helped[*at] |= left.verdict == Verdict::Complete;
    }
    Ok(candidates)
}

/// Whether it lowers the errors of all joints together.
fn helps(dataset: &ArmDataset, spec: &ArmSpec, candidate: &ArmCandidate) -> bool {
    add(dataset, spec, &candidate.term()).is_ok_and(|added| added.lowers_error)
}

/// Whether an effect that winds a gear up does so by all of the torque that the links take, as a gear
/// is; of every other effect.
fn winds_up_whole(candidate: &NamedCandidate) -> bool {
    let share = candidate.parameters.get(LOAD_SHARE);
    share.is_none_or(|share| WHOLE.contains(&share.value))
}

/// The model with one more effect.
fn with(spec: &ArmSpec, term: ArmTerm) -> ArmSpec {
    let mut more = spec.clone();
    more.effects.push(term);
    more
}

/// Of effects of the arm those that pass in a model with one more effect, too.
fn still_passing(
    dataset: &ArmDataset,
    more: &ArmSpec,
    passing: &[&Tried],
    weights: &[f64],
    told: &Told<'_>,
) -> Result<Vec<ArmCandidate>, ArmError> {
    let then = PreparedArm::new(dataset, more)?;
    let before: SharedFit = fit(&then);
    let count = ArmEffect::all(then.joints.len()).len();
    let again = passing.iter();
    let again = again.map(|own| try_one(&then, own.effect, &before, count));
    let mut again: Vec<Tried> = again.filter(|own| own.passes(weights)).collect();
    let gain = |own: &Tried| weighted_decrease(&own.decreases, weights).mean_square;
    again.sort_by(|a, b| gain(b).total_cmp(&gain(a)));
    // The others are the same torque in other words.
    again.truncate(1);
    Ok(again
        .iter()
        .map(|own| told.of_arm(own, Vec::new()))
        .collect())
}

fn joints(
    arm: &PreparedArm<'_>,
    each: &[Diagnosis],
    helped: &[bool],
) -> BTreeMap<String, JointDiagnosis> {
    let each = arm.joints.iter().zip(each).zip(helped);
    each.map(|((joint, own), helped)| {
        let told = JointDiagnosis {
            verdict: match helped {
                true => Verdict::Missing,
                false => own.verdict,
            },
            rms: own.rms,
            noise_floor: own.noise_floor,
            noise: own.noise,
            used: own.used.clone(),
        };
        (joint.name.clone(), told)
    })
    .collect()
}

fn suspected(arm: &PreparedArm<'_>, each: &[Diagnosis]) -> Vec<ArmSuspect> {
    let both = arm.joints.iter().zip(each);
    both.flat_map(|(joint, own)| {
        let suspect = |suspect: &Suspect| ArmSuspect {
            joint: joint.name.clone(),
            suspect: suspect.clone(),
        };
        own.suspected.iter().map(suspect)
    })
    .collect()
}

fn depends_on(arm: &PreparedArm<'_>, each: &[Diagnosis]) -> Vec<ArmDependence> {
    let both = arm.joints.iter().zip(each);
    let own = both.flat_map(|(joint, own)| {
        let told = |dependence: &Dependence| ArmDependence {
            joint: joint.name.clone(),
            dependence: dependence.clone(),
        };
        own.residual_depends_on.iter().map(told)
    });
    let mut all: Vec<ArmDependence> = own.collect();
    all.sort_by(|a, b| b.dependence.strength.total_cmp(&a.dependence.strength));
    all
}

/// What is told of candidates.
struct Told<'a> {
    arm: &'a PreparedArm<'a>,
    weights: &'a [f64],
}

impl Told<'_> {
    fn joint(&self, at: usize) -> Option<&ArmJoint> {
        self.arm.joints.get(at)
    }

    /// The candidates of joint number `at`.
    fn of_joint(&self, at: usize, diagnosis: &Diagnosis) -> Vec<ArmCandidate> {
        let Some(joint) = self.joint(at) else {
            return Vec::new();
        };
        let each = diagnosis.candidates.iter().map(|named| {
            let mut named = named.clone();
            let partner = name_partner(&mut named.parameters, joint);
            ArmCandidate {
                joint: Some(joint.name.clone()),
                partner,
                named,
            }
        });
        each.collect()
    }

    /// An effect of the arm, and those that explain as much.
    fn of_arm(&self, tried: &Tried, alike: Vec<&Tried>) -> ArmCandidate {
        let decrease = weighted_decrease(&tried.decreases, self.weights);
        let [share, share_std_error] = decrease.share();
        let term = self.arm.term(tried.effect);
        ArmCandidate {
            joint: term.joint,
            partner: None,
            named: NamedCandidate {
                effect: tried.effect.id().to_owned(),
                held_out_before: decrease.before,
                held_out_after: decrease.after,
                p_value: tried.p_value(),
                share,
                share_std_error,
                parameters: tried.parameters(self.arm),
                indistinguishable_from: (alike.iter())
                    .map(|own| self.arm.term(own.effect).to_string())
                    .collect(),
                separate_by: tried.effect.excited_by().to_owned(),
                next_experiment: Proposal::WidePosition,
            },
        }
    }
}
