//! From an experiment file to a twin.

use std::path::{Path, PathBuf};

use ferntast_identification::twin::{Twin, TwinError};
use ferntast_lab::{
    experiment::{self, Experiment, ExperimentError, Signals},
    recording::{self, LoadError},
};
use ferntast_msgs::{
    sample::{JointNames, MAX_TWIN_PARAMETERS},
    topics::{self, JointNameError},
};

/// How long the estimator of the parameters remembers \[s\].
const MEMORY: f64 = 20.0;

/// A twin, and what it has to be fed.
pub struct TwinModel {
    /// The twin, fitted to the experiment's recordings.
    pub twin: Twin,
    /// The arm's joints.
    pub joints: JointNames,
    /// The joint among them that it follows, from 0.
    pub joint: usize,
    /// Whether its recordings have a joint torque.
    pub joint_torque: bool,
    /// Whether its recordings have a temperature.
    pub temperature: bool,
}

/// Why an experiment cannot be followed on line.
#[derive(Debug, thiserror::Error)]
pub enum TwinOpenError {
    /// The experiment file cannot be used.
    #[error(transparent)]
    Experiment(#[from] ExperimentError),
    /// Its recordings cannot be used.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// It is about a contact.
    #[error(
        "{path}: it is about a contact, and a twin follows a joint; hold a contact against its recording by `ferntast lab compare`"
    )]
    Contact {
        /// The experiment file.
        path: PathBuf,
    },
    /// A signal is not one that a session has.
    #[error(
        "{path}: signals.{signal} is {found:?}; a twin follows one joint of a session, so it has to be {expected}"
    )]
    Signal {
        /// The experiment file.
        path: PathBuf,
        /// The signal.
        signal: &'static str,
        /// What the file says.
        found: String,
        /// What it may say.
        expected: String,
    },
    /// A joint has a name that topics cannot have.
    #[error(transparent)]
    Joint(#[from] JointNameError),
    /// The model cannot be followed, or the recordings are of no use for it.
    #[error("{path}: {source}")]
    Twin {
        /// The experiment file.
        path: PathBuf,
        /// What is wrong.
        source: TwinError,
    },
    /// Another experiment is about the same joint.
    #[error("{path}: {joint} has a twin already; give one experiment for each joint")]
    Twice {
        /// The experiment file.
        path: PathBuf,
        /// The joint.
        joint: String,
    },
    /// The message has no room for so many parameters.
    #[error(
        "{path}: the model has {found} parameters, a twin at most {MAX_TWIN_PARAMETERS}; leave some effects out"
    )]
    TooMany {
        /// The experiment file.
        path: PathBuf,
        /// How many there are.
        found: usize,
    },
}

/// Reads the experiment at `path` with its recordings, fits its model, and
/// makes a twin of it, for an arm of those joints. Takes as long as `ferntast lab fit`.
///
/// # Errors
///
/// See [`TwinOpenError`].
pub fn open(path: &Path, joints: JointNames) -> Result<TwinModel, TwinOpenError> {
    let experiment = Experiment::read(path, &experiment::data_folder())?;
    if experiment.joint.is_contact() {
        let path = path.to_owned();
        return Err(TwinOpenError::Contact { path });
    }
    let joint = joint_of(&experiment.signals, &joints, path)?;
    let loaded = recording::load(&experiment)?;
    let twin = Twin::new(&loaded.dataset, &experiment.model, MEMORY).map_err(|source| {
        TwinOpenError::Twin {
            path: path.to_owned(),
            source,
        }
    })?;
    let found = twin.parameters().len();
    if found > MAX_TWIN_PARAMETERS {
        let path = path.to_owned();
        return Err(TwinOpenError::TooMany { path, found });
    }
    Ok(TwinModel {
        twin,
        joints,
        joint,
        joint_torque: experiment.signals.joint_torque.is_some(),
        temperature: experiment.signals.temperature.is_some(),
    })
}

/// Opens each of `paths`, for an arm of those joints.
///
/// # Errors
///
/// See [`TwinOpenError`].
pub fn open_all(paths: &[PathBuf], joints: JointNames) -> Result<Vec<TwinModel>, TwinOpenError> {
    let mut models: Vec<TwinModel> = Vec::new();
    for path in paths {
        let model = open(path, joints)?;
        if models.iter().any(|own| own.joint == model.joint) {
            return Err(TwinOpenError::Twice {
                path: path.clone(),
                joint: joints.get(model.joint).unwrap_or_default().to_owned(),
            });
        }
        models.push(model);
    }
    Ok(models)
}

/// The joint (from 0) whose topics the signals are.
fn joint_of(signals: &Signals, joints: &JointNames, path: &Path) -> Result<usize, TwinOpenError> {
    let temperatures = topics::FOLLOWER_JOINT_TEMPERATURE.of_joints(joints)?;
    let measured = topics::FOLLOWER_MEASURED_JS.name;
    let motor = topics::FOLLOWER_MOTOR_JS.name;
    let refuse = |signal, found: &str, expected: String| TwinOpenError::Signal {
        path: path.to_owned(),
        signal,
        found: found.to_owned(),
        expected,
    };
    let position = |joint: usize| format!("{measured}.position[{joint}]");
    let mut topics = temperatures.iter().enumerate();
    let Some((joint, temperature)) = topics.find(|(joint, _)| signals.position == position(*joint))
    else {
        let positions: Vec<String> = (0..joints.len()).map(position).collect();
        let expected = positions.join(" or ");
        return Err(refuse("position", &signals.position, expected));
    };
    let asked = [
        (
            "motor_torque",
            Some(&signals.motor_torque),
            format!("{motor}.effort[{joint}]"),
        ),
        (
            "joint_torque",
            signals.joint_torque.as_ref(),
            format!("{measured}.effort[{joint}]"),
        ),
        (
            "temperature",
            signals.temperature.as_ref(),
            format!("{}.temperature", temperature.name),
        ),
    ];
    for (signal, found, expected) in asked {
        if let Some(found) = found.filter(|found| **found != expected) {
            return Err(refuse(signal, found, expected));
        }
    }
    Ok(joint)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn signals(joint: usize, temperature: usize) -> Signals {
        Signals {
            position: format!("/follower/measured_js.position[{joint}]"),
            motor_torque: format!("/follower/motor_js.effort[{joint}]"),
            joint_torque: Some(format!("/follower/measured_js.effort[{joint}]")),
            temperature: Some(format!(
                "/follower/joint_{temperature}/temperature.temperature"
            )),
            ..Signals::default()
        }
    }

    #[test]
    fn the_joint_is_that_of_the_signals() {
        let path = Path::new("e.toml");
        let two = JointNames::numbered(2);
        assert_eq!(joint_of(&signals(0, 1), &two, path).ok(), Some(0));
        assert_eq!(joint_of(&signals(1, 2), &two, path).ok(), Some(1));
    }

    #[test]
    fn signals_that_are_not_of_one_joint_are_refused() {
        let path = Path::new("e.toml");
        let mut other = signals(0, 1);
        other.motor_torque = "/follower/motor_js.effort[1]".to_owned();
        let mut column = signals(0, 1);
        column.position = "q_rad".to_owned();
        for (bad, words) in [
            (
                other,
                "signals.motor_torque is \"/follower/motor_js.effort[1]\"",
            ),
            (column, "/follower/measured_js.position[0] or"),
            (signals(1, 1), "/follower/joint_2/temperature.temperature"),
        ] {
            let error = joint_of(&bad, &JointNames::numbered(2), path)
                .unwrap_err()
                .to_string();
            assert!(error.contains(words) && error.contains("e.toml"), "{error}");
        }
    }
}
