//! Formulas for joints of an arm whose residual has no name.

use std::collections::BTreeMap;

use serde::Serialize;

use super::data::ArmDataset;
use super::diagnosis::{ArmCandidate, ArmDependence, JointDiagnosis, diagnose};
use super::error::ArmError;
use super::prepared::PreparedArm;
use super::spec::ArmSpec;
use crate::diagnosis::Verdict;
use crate::discovery::{self, Formula};
use crate::fit::Rms;

/// Share of the work that the diagnosis is.
const DIAGNOSIS: f64 = 0.5;

/// A formula for what one joint's model leaves. Signals of other joints are called
/// `position_NAME`, `velocity_NAME` and `load_NAME`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ArmFormula {
    /// The joint.
    pub joint: String,
    /// The formula.
    #[serde(flatten)]
    pub formula: Formula,
}

/// Formulas for what a model of an arm leaves, and the verdict that led there.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ArmDiscovery {
    /// Whether an effect is missing, and whether it is known.
    pub verdict: Verdict,
    /// Errors over all joints, each weighted by its noise \[Nm\].
    pub rms: Rms,
    /// Effects that pass all tests: they are added first.
    pub candidates: Vec<ArmCandidate>,
    /// Signals on which residuals depend, strongest first.
    pub residual_depends_on: Vec<ArmDependence>,
    /// Formulas, joint by joint from the base on, best first.
    pub formulas: Vec<ArmFormula>,
    /// Every joint.
    pub joints: BTreeMap<String, JointDiagnosis>,
    /// Terms in the dictionaries that were searched.
    pub tried: usize,
}

/// Diagnoses the arm, and proposes formulas for every joint that is unexplained.
///
/// `seed` decides what chance is taken to be. `progress` is called with the share
/// done, 0 … 1.
///
/// # Errors
///
/// See [`ArmError`].
pub fn discover(
    dataset: &ArmDataset,
    spec: &ArmSpec,
    seed: u64,
    progress: &mut dyn FnMut(f64),
) -> Result<ArmDiscovery, ArmError> {
    let diagnosis = diagnose(dataset, spec, &mut |done| progress(DIAGNOSIS * done))?;
    let arm = PreparedArm::new(dataset, spec)?;
    let is_open = |name: &String| {
        let own = diagnosis.joints.get(name);
        own.is_some_and(|own| own.verdict == Verdict::Unexplained)
    };
    let open: Vec<_> = (arm.joints.iter().filter(|own| is_open(&own.name))).collect();
    let (mut formulas, mut tried) = (Vec::new(), 0);
    for (number, joint) in open.iter().enumerate() {
        let found = discovery::discover(&joint.dataset, &joint.spec, seed, &mut |done| {
            let all = (number as f64 + done) / open.len() as f64;
            progress(DIAGNOSIS + (1.0 - DIAGNOSIS) * all);
        });
        let found = found.map_err(|source| ArmError::Joint {
            joint: joint.name.clone(),
            source: Box::new(source),
        })?;
        tried += found.tried;
        formulas.extend(found.formulas.into_iter().map(|formula| ArmFormula {
            joint: joint.name.clone(),
            formula,
        }));
    }
    progress(1.0);
    Ok(ArmDiscovery {
        verdict: diagnosis.verdict,
        rms: diagnosis.rms,
        candidates: diagnosis.candidates,
        residual_depends_on: diagnosis.residual_depends_on,
        formulas,
        joints: diagnosis.joints,
        tried,
    })
}
