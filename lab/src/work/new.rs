//! From a recording that somebody brought to an experiment file: signals guessed
//! from names and numbers, what was read told, the file written.

use std::path::{Path, PathBuf};

use ferntast_identification::{Inertia, JointType};
use serde::Serialize;

use super::{
    NewError, WorkError,
    doubt::{Taken, doubts},
    sources::Sources,
    start,
};
use crate::{
    experiment::{Join, Mapping, Place},
    guess::{Role, angle_unit, by_name, time_unit, unit_in_name},
    recording::Tally,
    table::ColumnSurvey,
    unit::{Quantity, Unit},
};

/// What a user says of one signal: `COLUMN` or `COLUMN:UNIT`.
#[derive(Clone, Debug, PartialEq)]
pub struct Said {
    /// Column or message path.
    pub column: String,
    /// Its unit, if said.
    pub unit: Option<String>,
}

impl Said {
    /// Reads `COLUMN` or `COLUMN:UNIT`; what is behind the last colon is a unit only
    /// where it is a known one.
    #[must_use]
    pub fn parse(text: &str) -> Said {
        match text.rsplit_once(':') {
            Some((column, unit)) if Unit::parse(unit).is_some() => Said {
                column: column.to_owned(),
                unit: Some(unit.to_owned()),
            },
            _ => Said {
                column: text.to_owned(),
                unit: None,
            },
        }
    }
}

/// What is to become of which files.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Request {
    /// Tables, MCAP files, folders.
    pub files: Vec<PathBuf>,
    /// What was said of signals.
    pub said: Vec<(Role, Said)>,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Rows in a second, where there is no time.
    pub rate_hz: Option<f64>,
    /// How files with different columns are joined.
    pub join: Option<Join>,
    /// Kind of joint; else as the units say.
    pub joint: Option<JointType>,
    /// The experiment file; else beside the first recording.
    pub output: Option<PathBuf>,
    /// Whether a file that is there may be written over.
    pub force: bool,
}

impl Request {
    pub(super) fn said(&self, role: Role) -> Option<&Said> {
        let mut said = self.said.iter().rev();
        said.find(|(own, _)| *own == role).map(|(_, said)| said)
    }
}

/// A signal of the new experiment.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NewSignal {
    /// Its key.
    pub signal: &'static str,
    /// Column or message path.
    pub column: String,
    /// The unit of what is recorded.
    pub unit: String,
    /// Least and greatest value in the recording, in that unit.
    pub range: Option<[f64; 2]>,
    /// Whether it was guessed.
    pub guessed: bool,
}

/// What was read and written.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Made {
    /// The experiment file.
    pub experiment: PathBuf,
    /// Kind of joint.
    pub joint: JointType,
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
    let sources = Sources::look(request)?;
    let Guessed {
        signals,
        questions,
        taken,
    } = guess(request, &sources);
    if let Some(question) = questions.into_iter().next() {
        return Err(question);
    }
    let mut warnings: Vec<String> = taken.iter().map(TakenFor::for_terminal).collect();
    warnings.extend(doubted(&signals, &sources));
    let joint = request.joint.unwrap_or_else(|| joint_of(&signals));
    let mapping = mapping(request, &sources, &signals, joint, &output);
    let opened = start(&mapping, None, &output, request.force)?.opened;
    warnings.extend(opened.notes.iter().cloned());
    Ok(Made {
        experiment: output,
        joint,
        signals,
        rate_hz: opened.rate_hz(),
        share_used: opened.share_used(),
        recordings: opened.tallies,
        warnings,
    })
}

/// What is odd about units that were said.
fn doubted(signals: &[NewSignal], sources: &Sources) -> Vec<String> {
    let taken = signals.iter().filter_map(|own| {
        let survey = sources.column(&own.column)?;
        Some(Taken {
            key: own.signal,
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
    joint: JointType,
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
            .map(|signal| (signal.signal.to_owned(), place(signal)))
            .collect(),
        inertia: Inertia::Fit,
        gear_ratio: None,
        effects: ["coulomb", "viscous"].map(str::to_owned).to_vec(),
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

/// A joint that moves along a line, where a unit says so.
pub(super) fn joint_of(signals: &[NewSignal]) -> JointType {
    let is_linear = |signal: &NewSignal| {
        let quantity = Unit::parse(&signal.unit).map(|unit| unit.quantity());
        matches!(quantity, Some(Quantity::Length | Quantity::Force))
    };
    match signals.iter().any(is_linear) {
        true => JointType::Prismatic,
        false => JointType::Revolute,
    }
}

/// Signals as far as they are clear.
#[derive(Default)]
pub(super) struct Guessed {
    pub(super) signals: Vec<NewSignal>,
    /// What the user has to say, [`NewError::Unsure`].
    pub(super) questions: Vec<NewError>,
    /// What was taken for granted.
    pub(super) taken: Vec<TakenFor>,
}

/// What was taken for granted.
pub(super) struct TakenFor {
    pub(super) text: String,
    /// The option that says otherwise.
    option: String,
}

impl TakenFor {
    fn for_terminal(&self) -> String {
        match self.option.as_str() {
            "" => self.text.clone(),
            option => format!("{}; {option}", self.text),
        }
    }
}

/// Signals and their units, as they were said, or by names and numbers. Without its
/// unit is one that is asked for.
pub(super) fn guess(request: &Request, sources: &Sources) -> Guessed {
    let mut guessed = Guessed::default();
    if sources.tables && request.rate_hz.is_none() {
        let mut taken = Vec::new();
        match time(request, sources, &mut taken) {
            Ok(signal) => guessed.signals.push(signal),
            Err(question) => guessed.questions.push(question),
        }
        guessed.taken.append(&mut taken);
    }
    let torque = must(request, sources, Role::MotorTorque);
    let position = must(request, sources, Role::Position);
    let mut torque = guessed.or_ask(torque);
    let mut position = guessed.or_ask(position);
    if let Some(torque) = torque.as_mut().filter(|own| own.unit.is_empty()) {
        let linear = request.joint == Some(JointType::Prismatic);
        torque.unit = if linear { "N" } else { "Nm" }.to_owned();
        if sources.tables {
            guessed.taken.push(TakenFor {
                text: format!(
                    "signals.motor_torque: nothing says the unit of {:?}, taken for {}",
                    torque.column, torque.unit
                ),
                option: format!(
                    "a current or voltage is told by --motor-torque {}:A, or :V",
                    torque.column
                ),
            });
        }
    }
    if let Some(position) = position.as_mut().filter(|own| own.unit.is_empty()) {
        let force = torque.as_ref().and_then(|own| Unit::parse(&own.unit));
        let linear = force.map(|unit| unit.quantity()) == Some(Quantity::Force)
            || request.joint == Some(JointType::Prismatic);
        let range = position
            .range
            .map_or(0.0, |[least, greatest]| greatest - least);
        match angle_unit(range).filter(|_| !linear) {
            Some(unit) => guessed.questions.push(unsure(
                Role::Position,
                format!(
                    "{:?} goes over {range:.0}, which is many turns in rad: it may be in {unit}",
                    position.column
                ),
                vec![
                    format!("{}:{unit}", position.column),
                    format!("{}:rad", position.column),
                ],
                sources,
            )),
            None => position.unit = if linear { "m" } else { "rad" }.to_owned(),
        }
    }
    let position_unit = position.as_ref().and_then(|own| Unit::parse(&own.unit));
    let linear = position_unit.map(|unit| unit.quantity()) == Some(Quantity::Length);
    guessed.signals.extend(position);
    guessed.signals.extend(torque);
    let others = [
        (Role::JointTorque, if linear { "N" } else { "Nm" }),
        (Role::Temperature, "degC"),
    ];
    for (role, usual) in others {
        let signal = find(request, sources, role);
        let taken = |column: &String| guessed.signals.iter().any(|own| own.column == *column);
        match signal {
            Ok(Some(mut signal)) if !taken(&signal.column) => {
                if signal.unit.is_empty() {
                    signal.unit = usual.to_owned();
                }
                guessed.signals.push(signal);
            }
            Ok(_) => {}
            Err(question) => guessed.questions.push(question),
        }
    }
    guessed
}

impl Guessed {
    /// What is found; else the question is asked.
    fn or_ask(&mut self, found: Result<NewSignal, NewError>) -> Option<NewSignal> {
        found.map_err(|question| self.questions.push(question)).ok()
    }
}

/// The column that is time, by its name or because it ascends.
fn time(
    request: &Request,
    sources: &Sources,
    taken: &mut Vec<TakenFor>,
) -> Result<NewSignal, NewError> {
    let mut signal = match find(request, sources, Role::Time)? {
        Some(signal) => signal,
        None => {
            let mut ascending = sources.columns.iter().filter(|own| own.ascends);
            match (ascending.next(), ascending.next()) {
                (Some(own), None) => {
                    taken.push(TakenFor {
                        text: format!(
                            "signals.time: {:?} is taken for time, since it alone ascends",
                            own.name
                        ),
                        option: String::new(),
                    });
                    signal_of(Role::Time, own, None, true)
                }
                _ => {
                    let why = "no column is called time or t";
                    return Err(unsure(Role::Time, why.to_owned(), Vec::new(), sources));
                }
            }
        }
    };
    if signal.unit.is_empty() {
        let survey = sources.column(&signal.column);
        let (first, step) = survey.map_or((0.0, 0.0), |own| (own.first, own.step));
        signal.unit = match time_unit(first, step) {
            Some(unit) => {
                taken.push(TakenFor {
                    text: format!(
                        "signals.time: {:?} goes in steps of {step}, which cannot be s: taken for {unit}",
                        signal.column
                    ),
                    option: format!("--time {}:s if that is right", signal.column),
                });
                unit.to_owned()
            }
            None => "s".to_owned(),
        };
    }
    Ok(signal)
}

fn must(request: &Request, sources: &Sources, role: Role) -> Result<NewSignal, NewError> {
    find(request, sources, role)?.ok_or_else(|| {
        let why = format!("nothing is called like a {}", role.key());
        unsure(role, why, Vec::new(), sources)
    })
}

/// The signal as it was said, or by its name; its unit as said, or as the file
/// says; empty where nothing does.
fn find(request: &Request, sources: &Sources, role: Role) -> Result<Option<NewSignal>, NewError> {
    if let Some(said) = request.said(role) {
        // A path with functions at its end is checked when it is read.
        let bare = said.column.split(".@").next().unwrap_or_default();
        let Some(column) = sources
            .column(&said.column)
            .or_else(|| sources.column(bare))
        else {
            if !sources.tables {
                let mut signal = signal_of(role, &ColumnSurvey::default(), None, false);
                signal.column.clone_from(&said.column);
                signal.unit = said.unit.clone().unwrap_or_default();
                return Ok(Some(signal));
            }
            let why = format!("there is no column {:?}", said.column);
            return Err(unsure(role, why, Vec::new(), sources));
        };
        let mut signal = signal_of(role, column, said.unit.as_deref(), false);
        signal.column.clone_from(&said.column);
        return Ok(Some(signal));
    }
    let names: Vec<&str> = sources
        .columns
        .iter()
        .map(|own| own.name.as_str())
        .collect();
    let found = by_name(role, &names);
    match found.as_slice() {
        [] => Ok(None),
        [(name, unit)] => {
            let column = sources.column(name);
            Ok(column.map(|own| {
                let mut signal = signal_of(role, own, None, true);
                if signal.unit.is_empty() {
                    signal.unit = unit.unwrap_or_default().to_owned();
                }
                signal
            }))
        }
        // More than one of what need not be there: none is taken.
        several if matches!(role, Role::Position | Role::MotorTorque | Role::Time) => {
            let names: Vec<String> = several.iter().map(|(name, _)| (*name).to_owned()).collect();
            let why = format!("it can be {}", names.join(" or "));
            Err(unsure(role, why, names, sources))
        }
        _ => Ok(None),
    }
}

fn signal_of(role: Role, column: &ColumnSurvey, said: Option<&str>, guessed: bool) -> NewSignal {
    let in_name = unit_in_name(&column.name).1;
    let unit = said.map(str::to_owned).or_else(|| column.unit.clone());
    let unit = unit.or_else(|| in_name.map(|unit| unit.name().to_owned()));
    NewSignal {
        signal: role.key(),
        column: column.name.clone(),
        unit: unit.unwrap_or_default(),
        range: (column.numbers > 0).then_some([column.least, column.greatest]),
        guessed,
    }
}

fn unsure(role: Role, why: String, choices: Vec<String>, sources: &Sources) -> NewError {
    let columns = sources.columns.iter().map(|own| own.name.clone());
    NewError::Unsure {
        role,
        why,
        choices,
        columns: columns.collect(),
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
