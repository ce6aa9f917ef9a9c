//! Goes on in the lab with what a twin found while the arm moved.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use ferntast_bag::BagReader;
use ferntast_identification::{Term, add};
use ferntast_model::friction::{FASTEST_SEEN, REFERENCE_TEMPERATURE};
use ferntast_msgs::{
    sample::{JointSample, MAX_JOINTS, TwinParametersSample, TwinVerdict},
    topics,
};
use serde::Serialize;

use super::{Opened, WorkError, add::fitted};
use crate::experiment::{
    self, Experiment, ExperimentError, FittedParameter, NextStep, write_child,
};

/// What became of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FromTwin {
    /// The new experiment file.
    pub experiment: PathBuf,
    /// The effect that the twin named as missing and that was added.
    pub effect: Option<String>,
    /// What the model as identified off line left of the torque while the twin
    /// ran: it never saw that recording \[Nm\].
    pub held_out_before: f64,
    /// Error of the new model on parts of the recording left out of its fit \[Nm\].
    pub held_out_after: f64,
    /// Unit of both.
    pub unit: String,
    /// The parameters: as the twin found them, or fitted where an effect was added.
    pub parameters: BTreeMap<String, FittedParameter>,
}

/// The last word in a recording of the twin whose joint's position is `position`, or of
/// another where that has none; where its joint stands in joint states, and the RMS of its
/// residual \[Nm\].
fn last_word(path: &Path, position: &str) -> Result<(TwinParametersSample, usize, f64), WorkError> {
    let twin = |reason: String| WorkError::Twin {
        path: path.to_owned(),
        reason,
    };
    let bag = BagReader::open(path).map_err(ExperimentError::from)?;
    let has = |name: &str| bag.topics().any(|topic| topic.name == name);
    let none = || WorkError::NoTwin {
        path: path.to_owned(),
    };
    if !has(&topics::TWIN_PARAMETERS.name) || !has(&topics::TWIN_RESIDUAL_JS.name) {
        return Err(none());
    }
    let words = bag
        .messages::<TwinParametersSample>(&topics::TWIN_PARAMETERS.name)
        .map_err(|error| twin(error.to_string()))?;
    let mut last: BTreeMap<String, TwinParametersSample> = BTreeMap::new();
    for word in words {
        let word = word.map_err(|error| twin(error.to_string()))?.message;
        last.insert(word.joint.to_string(), word);
    }
    let residuals = bag
        .messages::<JointSample>(&topics::TWIN_RESIDUAL_JS.name)
        .map_err(|error| twin(error.to_string()))?;
    let mut joints = None;
    let mut sums = [(0.0, 0_u64); MAX_JOINTS];
    for residual in residuals {
        let residual = residual.map_err(|error| twin(error.to_string()))?.message;
        joints = Some(residual.joints);
        for ((squares, count), own) in sums.iter_mut().zip(residual.effort) {
            // Zero: a joint that does not slide now, or has no twin.
            if own != 0.0 {
                *squares += own * own;
                *count += 1;
            }
        }
    }
    let joints = joints.ok_or_else(none)?;
    let place = |word: &TwinParametersSample| joints.index(word.joint.as_str());
    let meant = |word: &&TwinParametersSample| {
        place(word).is_some_and(|joint| position.ends_with(&format!("[{joint}]")))
    };
    let word = last.values().find(meant).or_else(|| last.values().next());
    let word = *word.ok_or_else(none)?;
    let joint = place(&word).ok_or_else(none)?;
    let (squares, count) = sums.get(joint).copied().unwrap_or_default();
    Ok((word, joint, (squares / count.max(1) as f64).sqrt()))
}

/// Writes to `output` the experiment `model` on the `recording` in which its
/// twin ran, with the effect that the twin named as missing and, in the
/// lineage, the parameters that it found.
///
/// # Errors
///
/// [`WorkError`]; nothing is written then.
pub fn from_twin(model: &Path, recording: &Path, output: &Path) -> Result<FromTwin, WorkError> {
    if output.exists() {
        return Err(WorkError::Exists {
            path: output.to_owned(),
        });
    }
    let parent = Experiment::read(model, &experiment::data_folder())?;
    let position = &parent.signals.position;
    let (word, joint, held_out_before) = last_word(recording, position)?;
    let other = |reason: String| WorkError::OtherModel {
        path: recording.to_owned(),
        reason,
    };
    if !position.ends_with(&format!("[{joint}]")) {
        return Err(other(format!(
            "its twin followed {}, the experiment's position is {position}",
            word.joint
        )));
    }
    let opened = Opened::read(Experiment {
        recordings: vec![recording.to_owned()],
        held_out: Vec::new(),
        unloaded: Vec::new(),
        ..parent.clone()
    })?;
    let comparison = opened.compare()?;
    let found = (0..word.len()).map(|i| word.names[i].as_str());
    let own = |name: &&str| ![REFERENCE_TEMPERATURE, FASTEST_SEEN].contains(name);
    for name in found.filter(own) {
        if !comparison.parameters.contains_key(name) {
            return Err(other(format!("its twin has {name}, the model has not")));
        }
    }
    let missing = match word.verdict == TwinVerdict::MISSING && !word.candidate.is_empty() {
        true => Some(Term::Catalogue(word.candidate.to_string())),
        false => None,
    };
    let (held_out_after, parameters) = match &missing {
        Some(effect) => {
            let addition = add(&opened.dataset, &parent.model, effect)
                .map_err(|error| opened.refuse(error))?;
            (addition.held_out_after, fitted(&addition.parameters))
        }
        None => {
            let mut parameters = fitted(&comparison.parameters);
            for i in 0..word.len() {
                if let Some(own) = parameters.get_mut(word.names[i].as_str()) {
                    own.value = word.values[i];
                    // A shape keeps its value and error off line.
                    if word.std_errors[i] > 0.0 {
                        own.std_error = own.std_error.and(Some(word.std_errors[i]));
                    }
                }
            }
            (comparison.rms.held_out, parameters)
        }
    };
    let step = NextStep {
        effect: missing,
        twin_recording: Some(recording.to_owned()),
        held_out_before,
        held_out_after,
        unit: opened.torque_unit().to_owned(),
        parameters,
    };
    write_child(&parent, &step, output)?;
    Ok(FromTwin {
        experiment: output.to_owned(),
        effect: step.effect.map(|effect| effect.name().to_owned()),
        held_out_before,
        held_out_after,
        unit: step.unit,
        parameters: step.parameters,
    })
}
