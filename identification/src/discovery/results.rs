//! What a search for formulas returns.

use std::collections::BTreeMap;

use ferntast_model::friction::Proposal;
use serde::Serialize;

use super::map::FormulaMap;
use crate::diagnosis::dependence::Dependence;
use crate::diagnosis::{Diagnosis, Verdict};
use crate::fit::{Parameter, Rms};

/// A formula that explains what the model leaves.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Formula {
    /// A name for it that the model has not yet.
    pub name: String,
    /// The torque (of a contact the force) that it adds, as
    /// [`CustomEffect::expression`](crate::CustomEffect::expression) has it: places and
    /// scales are numbers in it, the coefficients are fitted.
    pub expression: String,
    /// The same with names for all constants, those of `parameters`.
    pub form: String,
    /// All its constants: coefficients, and the places and scales within.
    pub parameters: BTreeMap<String, Parameter>,
    /// Signals that it reads.
    pub signals: Vec<String>,
    /// RMS on rows left out without it \[Nm\].
    pub held_out_before: f64,
    /// With it \[Nm\]: what the model with `expression` gives.
    pub held_out_after: f64,
    /// Share of the residual's mean square by which the error on rows left out falls.
    pub share: f64,
    /// Its standard error.
    pub share_std_error: f64,
    /// How often chance alone explains as much in the same search, of its least
    /// certain term: the signs of blocks of time turned at random.
    pub p_value: f64,
    /// Signals, functions and constants in it.
    pub complexity: usize,
    /// Formulas that explain these data as well.
    pub cannot_be_told_from: Vec<String>,
    /// The recording that would tell them apart, or confirm the one.
    pub next_experiment: Proposal,
    /// What to do, in words.
    pub separate_by: String,
    /// The formula beside what was measured.
    pub map: FormulaMap,
}

/// An effect of the catalogue that is missing.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NamedEffect {
    /// Its id.
    pub effect: String,
    /// RMS on rows left out with it \[Nm\].
    pub held_out_after: f64,
}

/// Formulas for what a model leaves, and the verdict that led there.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Discovery {
    /// Samples in the recordings.
    pub samples: usize,
    /// Rows of the regression.
    pub used: usize,
    /// What the catalogue says.
    pub verdict: Verdict,
    /// Effects of the catalogue that are missing, best first.
    pub named: Vec<NamedEffect>,
    /// Error of the model as it is.
    pub rms: Rms,
    /// RMS between repeats \[Nm\], where anything was repeated.
    pub noise_floor: Option<f64>,
    /// Signals on which the residual depends, strongest first.
    pub residual_depends_on: Vec<Dependence>,
    /// Formulas, best first: the simplest of those that explain most, then others that
    /// are simpler or explain more.
    pub formulas: Vec<Formula>,
    /// Terms in the dictionary that was searched.
    pub tried: usize,
}

impl Discovery {
    pub(super) fn without_formulas(diagnosis: &Diagnosis) -> Self {
        let named = diagnosis.candidates.iter();
        Self {
            samples: diagnosis.samples,
            used: diagnosis.used.rows,
            verdict: diagnosis.verdict,
            named: named
                .map(|own| NamedEffect {
                    effect: own.effect.clone(),
                    held_out_after: own.held_out_after,
                })
                .collect(),
            rms: diagnosis.rms,
            noise_floor: diagnosis.noise_floor,
            residual_depends_on: diagnosis.residual_depends_on.clone(),
            formulas: Vec::new(),
            tried: 0,
        }
    }
}
