//! What a diagnosis returns.

use std::collections::BTreeMap;

use ferntast_model::friction::Proposal;
use serde::{Deserialize, Serialize};

use super::dependence::Dependence;
use super::not_tested::NotTested;
use crate::comparison::noise_floor::NoiseFloor;
use crate::comparison::usage::Usage;
use crate::comparison::varies_together::VariesTogether;
use crate::fit::{Parameter, Rms, Soundness};

/// What a residual says of the model, on the samples that are used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// An effect of the catalogue is missing.
    Missing,
    /// No systematic rest: on the samples used the residual depends on no signal that
    /// is recorded and not on its own past, and no effect of the catalogue lowers the error.
    Complete,
    /// The residual depends on signals, or on its own past, in a way that no effect of the catalogue has.
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

/// An effect that was tried and is not named.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunnerUp {
    /// Its id.
    pub effect: String,
    /// Share of the residual's mean square that it explains on rows left out, each
    /// session with its own parameters of the model.
    pub share: f64,
    /// p-value, corrected for all variants tried.
    pub p_value: f64,
    /// Why it is not named.
    pub why_not: WhyNot,
}

/// Why an effect that was tried is not named.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum WhyNot {
    /// Sign or size of its parameters is not possible.
    Implausible,
    /// It explains next to nothing.
    TooSmall,
    /// Chance explains as much.
    NotSignificant,
    /// It does not lower the error on rows left out by more than that is uncertain, or
    /// is a part of what another one is.
    NoGain,
}

impl WhyNot {
    /// In words.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::Implausible => "its parameters are not possible",
            Self::TooSmall => "explains next to nothing",
            Self::NotSignificant => "chance explains as much",
            Self::NoGain => "does not lower the error for certain, or another one contains it",
        }
    }
}

/// The verdict with other filters.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VerdictAtCutoff {
    /// Frequency \[Hz\] above which torque and columns are filtered away.
    pub cutoff_hz: f64,
    /// Share of the samples that is used then.
    pub share: f64,
    /// The verdict; `None` where too few rows remain.
    pub verdict: Option<Verdict>,
    /// The effect that is named first.
    pub effect: Option<String>,
    /// Whether verdict and name are those of the diagnosis: that name, or one that
    /// these data cannot tell from it.
    pub agrees: bool,
}

/// Result of a diagnosis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Diagnosis {
    /// Samples in the recordings that are fitted.
    pub samples: usize,
    /// What of the recordings the verdict rests on, and what not, for which reason.
    pub used: Usage,
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
    /// Where the verdict is unexplained: effects that pass all tests and lower the
    /// error, though they are not the explanation. Best first.
    pub helps_in_part: Vec<NamedCandidate>,
    /// The strongest of those that were tried and not named, best first.
    pub runners_up: Vec<RunnerUp>,
    /// Verdicts with other filters: empty where they were not asked for.
    pub verdict_at_other_cutoffs: Vec<VerdictAtCutoff>,
    /// Whether the model's parameters can be told apart, and are possible:
    /// `condition`, `inseparable`, `implausible`.
    #[serde(flatten)]
    pub soundness: Soundness,
    /// Signals and conditions that vary together from session to session: an effect of one
    /// cannot be told from an effect of the other.
    pub varies_together: Vec<VariesTogether>,
    /// Signals on which the residual depends, strongest first.
    pub residual_depends_on: Vec<Dependence>,
    /// Effects and shapes tried.
    pub tried: usize,
    /// What these recordings cannot show, whatever the verdict: `not_tested`, `why_not_tested`.
    #[serde(flatten)]
    pub not_tested: NotTested,
}

impl Diagnosis {
    /// What the verdict claims, as a sentence; no more than the samples used allow.
    #[must_use]
    pub fn claim(&self) -> String {
        let where_ = self.used.claim();
        match self.verdict {
            Verdict::Missing => {
                let first = self.candidates.first();
                let name = first.map_or("an effect of the catalogue", |own| own.effect.as_str());
                format!("{name} explains what the model leaves in the {where_} used")
            }
            Verdict::Complete => format!("no systematic rest in the {where_} used"),
            Verdict::Unexplained => {
                format!("in the {where_} used something is left that the catalogue does not have")
            }
        }
    }

    /// Where the verdict is another with other filters: a warning.
    #[must_use]
    pub fn cutoff_warning(&self) -> Option<String> {
        let others = self.verdict_at_other_cutoffs.iter();
        let other: Vec<String> = others
            .filter(|own| !own.agrees)
            .map(|own| format!("{} at {:.3} Hz", own.text(), own.cutoff_hz))
            .collect();
        (!other.is_empty()).then(|| {
            format!(
                "the verdict depends on the filter: {} (here the cut-off is {:.3} Hz)",
                other.join(", "),
                self.used.cutoff_hz
            )
        })
    }
}

impl Verdict {
    /// As in results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Missing => "missing",
            Self::Complete => "complete",
            Self::Unexplained => "unexplained",
        }
    }
}

impl VerdictAtCutoff {
    /// Verdict and name in words.
    #[must_use]
    pub fn text(&self) -> String {
        match (self.verdict, &self.effect) {
            (None, _) => "too few rows".to_owned(),
            (Some(verdict), Some(effect)) => format!("{}, {effect}", verdict.name()),
            (Some(verdict), None) => verdict.name().to_owned(),
        }
    }
}
