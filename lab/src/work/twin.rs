//! Goes on in the lab with what a twin found while the arm moved.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use ferntast_bus::mcap::BagReader;
use ferntast_identification::{Term, add};
use ferntast_model::friction::REFERENCE_TEMPERATURE;
use ferntast_msgs::{
    sample::{JointSample, TwinParametersSample, TwinVerdict},
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

/// The twin's last word in a recording, where its joint stands in joint states,
/// and the RMS of its residual \[Nm\].
fn last_word(path: &Path) -> Result<(TwinParametersSample, usize, f64), WorkError> {
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
    let mut last = None;
    for word in words {
        last = Some(word.map_err(|error| twin(error.to_string()))?.message);
    }
    let last: TwinParametersSample = last.ok_or_else(none)?;
    let residuals = bag
        .messages::<JointSample>(&topics::TWIN_RESIDUAL_JS.name)
        .map_err(|error| twin(error.to_string()))?;
    let mut joint = None;
    let (mut squares, mut count) = (0.0, 0_u64);
    for residual in residuals {
        let residual = residual.map_err(|error| twin(error.to_string()))?.message;
        joint = residual.joints.index(last.joint.as_str());
        let own = joint.and_then(|joint| residual.effort.get(joint).copied());
        squares += own.unwrap_or(0.0).powi(2);
        count += 1;
    }
    let joint = joint.ok_or_else(none)?;
    Ok((last, joint, (squares / count.max(1) as f64).sqrt()))
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
    let (word, joint, held_out_before) = last_word(recording)?;
    let other = |reason: String| WorkError::OtherModel {
        path: recording.to_owned(),
        reason,
    };
    let position = &parent.signals.position;
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
    for name in found.filter(|name| *name != REFERENCE_TEMPERATURE) {
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
                    // A shape has none.
                    own.std_error = own.std_error.and(Some(word.std_errors[i]));
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
