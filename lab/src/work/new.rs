//! From a recording that somebody brought to an experiment file: signals guessed
//! from names and numbers, what was read told, the file written.

use std::path::{Path, PathBuf};

use ferntast_identification::{Inertia, JointType};
use serde::Serialize;

use super::{
    NewError, WorkError,
    chain::ArmChain,
    doubt::{Taken, doubts},
    new_signal::{Guessed, NewSignal, TakenFor},
    request::Request,
    signals::guess,
    signals_of_joint::joint_of,
    sources::Sources,
    start,
};
use crate::{
    experiment::{ArmPart, Mapping, Place},
    recording::Tally,
};

/// What was read and written.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Made {
    /// The experiment file.
    pub experiment: PathBuf,
    /// Kind of joint, or a contact; of an arm that of its first joint.
    pub joint: JointType,
    /// The joints of an arm, from the base on.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub joints: Vec<String>,
    /// Its signals.
    pub signals: Vec<NewSignal>,
    /// Mean rate \[Hz\].
    pub rate_hz: f64,
    /// What of each recording is used.
    pub recordings: Vec<Tally>,
    /// Share of all samples that is used.
    pub share_used: f64,
    /// What looks implausible, or was taken for granted.
    pub warnings: Vec<String>,
}

/// Makes the experiment file that is asked for.
///
/// # Errors
///
/// [`NewError::Unsure`] where the user has to say more; nothing is written then,
/// nor where the recordings cannot be used.
pub fn make(request: &Request) -> Result<Made, NewError> {
    let output = output(request)?;
    let chain = request.arm.as_ref().map(ArmChain::read).transpose()?;
    let sources = Sources::look(request, chain.as_ref())?;
    let Guessed {
        signals,
        questions,
        taken,
    } = guess(request, &sources, chain.as_ref());
    if let Some(question) = questions.into_iter().next() {
        return Err(question);
    }
    let mut warnings: Vec<String> = taken.iter().map(TakenFor::for_terminal).collect();
    warnings.extend(doubted(&signals, &sources));
    let joint = kind(request, chain.as_ref(), &signals);
    let joints = chain.map_or_else(Vec::new, |own| own.joints);
    let joints: Vec<String> = joints.into_iter().map(|own| own.name).collect();
    let mapping = mapping(request, &sources, &signals, (joint, &joints), &output);
    let read = start(&mapping, None, &output, request.force)?.read;
    warnings.extend(read.notes);
    Ok(Made {
        experiment: output,
        joint,
        joints,
        signals,
        rate_hz: read.rate_hz,
        share_used: read.share_used,
        recordings: read.recordings,
        warnings,
    })
}

/// Kind of joint, as it was said or as the units say; of an arm that of its first joint.
pub(super) fn kind(
    request: &Request,
    chain: Option<&ArmChain>,
    signals: &[NewSignal],
) -> JointType {
    match chain.and_then(|chain| chain.joints.first()) {
        Some(first) => first.joint,
        None => request.joint.unwrap_or_else(|| joint_of(signals)),
    }
}

/// What is odd about units that were said.
fn doubted(signals: &[NewSignal], sources: &Sources) -> Vec<String> {
    let taken = signals.iter().filter_map(|own| {
        let survey = sources.column(&own.column)?;
        Some(Taken {
            key: &own.signal,
            column: &own.column,
            unit: &own.unit,
            first: survey.first,
            step: survey.step,
            range: survey.range(),
        })
    });
    let told = doubts(taken).into_iter();
    told.map(|own| format!("signals.{}: {}", own.signal, own.text))
        .collect()
}

/// What the file is to say: a model to begin with, all files fitted.
fn mapping(
    request: &Request,
    sources: &Sources,
    signals: &[NewSignal],
    (joint, joints): (JointType, &[String]),
    output: &Path,
) -> Mapping {
    let folder = match output.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    };
    let names = |files: &Vec<PathBuf>| files.iter().map(|file| name_from(folder, file)).collect();
    let place = |signal: &NewSignal| Place {
        column: signal.column.clone(),
        unit: Some(signal.unit.clone()).filter(|unit| !unit.is_empty()),
        time: None,
    };
    Mapping {
        recordings: sources.recordings.iter().map(names).collect(),
        held_out: Vec::new(),
        columns: request.columns.clone(),
        rate_hz: request.rate_hz,
        join: request.join,
        joint,
        signals: signals
            .iter()
            .map(|signal| (signal.signal.clone(), place(signal)))
            .collect(),
        arm: request.arm.as_ref().map(|own| ArmPart {
            urdf: name_from(folder, &own.urdf),
            joints: joints.to_vec(),
            drive_gain: own.drive_gain.clone(),
            ..ArmPart::default()
        }),
        contour: request.contour.clone(),
        inertia: match joint.is_contact() || !joints.is_empty() {
            true => Inertia::Given(0.0),
            false => Inertia::Fit,
        },
        gear_ratio: None,
        effects: match joint.is_contact() {
            true => vec!["contact_coulomb".to_owned()],
            false => ["coulomb", "viscous"].map(str::to_owned).to_vec(),
        },
    }
}

fn output(request: &Request) -> Result<PathBuf, NewError> {
    let first = request.files.first().ok_or(NewError::NoFile)?;
    let output = match &request.output {
        Some(output) => output.clone(),
        None if first.is_dir() => {
            let name = first.file_name().unwrap_or("recording".as_ref());
            first.with_file_name(format!("{}.toml", name.to_string_lossy()))
        }
        None => first.with_extension("toml"),
    };
    match output.exists() && !request.force {
        true => Err(WorkError::Exists { path: output }.into()),
        false => Ok(output),
    }
}

/// Files of one folder or list as an experiment in `folder` names them.
fn name_from(folder: &Path, file: &Path) -> String {
    let turned = match (file.canonicalize(), folder.canonicalize()) {
        (Ok(file), Ok(folder)) => file
            .strip_prefix(&folder)
            .map(Path::to_owned)
            .unwrap_or(file),
        _ => file.to_owned(),
    };
    turned.to_string_lossy().into_owned()
}
