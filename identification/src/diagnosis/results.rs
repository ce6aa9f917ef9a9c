//! What a diagnosis returns.

use std::collections::BTreeMap;

use ferntast_model::friction::Proposal;
use serde::Serialize;

use super::dependence::Dependence;
use crate::comparison::noise_floor::NoiseFloor;
use crate::fit::{Parameter, Rms};

/// Whether the model is complete.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// An effect of the catalogue is missing.
    Missing,
    /// Nothing is missing: the residual is noise.
    Complete,
    /// The residual depends on signals in a way that no effect of the catalogue has.
    Unexplained,
}

/// An effect that passes all tests.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NamedCandidate {
    /// Its id.
    pub effect: String,
    /// RMS on rows left out without it \[Nm\].
    pub held_out_before: f64,
    /// With it \[Nm\].
    pub held_out_after: f64,
    /// p-value by leaving blocks out in turn, or by the variation between sessions,
    /// corrected for all variants tried.
    pub p_value: f64,
    /// Share of the residual's mean square by which the error on rows left out falls.
    pub share: f64,
    /// Its standard error.
    pub share_std_error: f64,
    /// Its parameters.
    pub parameters: BTreeMap<String, Parameter>,
    /// Ids of effects that explain these data as well.
    pub indistinguishable_from: Vec<String>,
    /// Motion or condition that would distinguish them, or confirm the one: the id
    /// of `next_experiment`, and its instruction.
    pub separate_by: String,
    /// What to record next.
    pub next_experiment: Proposal,
}

/// An effect that these recordings suggest, but that is not significant.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Suspect {
    /// Its id.
    pub effect: String,
    /// p-value by the variation between sessions, not corrected for the number of
    /// effects tried.
    pub p_value: f64,
    /// Share of the residual's mean square that it explains on rows left out.
    pub share: f64,
    /// The recording that would decide it.
    pub next_experiment: Proposal,
}

/// Result of a diagnosis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Diagnosis {
    /// Samples in the recordings.
    pub samples: usize,
    /// Rows of the regression: filtered, thinned, away from rest.
    pub used: usize,
    /// Whether an effect is missing, and whether it is known.
    pub verdict: Verdict,
    /// Error of the model as it is.
    pub rms: Rms,
    /// RMS between repeats \[Nm\], where anything was repeated.
    pub noise_floor: Option<f64>,
    /// RMS between repeats, and variation between sessions.
    pub noise: NoiseFloor,
    /// Effects that pass all tests, best first.
    pub candidates: Vec<NamedCandidate>,
    /// Where nothing passes: effects that show between sessions, of which there are
    /// too few to distinguish them from random variation. Best first.
    pub suspected: Vec<Suspect>,
    /// Signals on which the residual depends, strongest first.
    pub residual_depends_on: Vec<Dependence>,
    /// Effects and shapes tried.
    pub tried: usize,
    /// Effects that these recordings cannot show, whatever the verdict: coupling
    /// with joints whose motion is not among them.
    pub not_tested: Vec<String>,
}
