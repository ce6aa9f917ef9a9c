//! A signal of the new experiment: the column that was said, else the one that is called like it.

use serde::Serialize;

use super::{
    NewError,
    error::in_runs,
    request::{Request, Said},
    sources::Sources,
};
use crate::{
    guess::{Role, by_name, unit_in_name},
    table::ColumnSurvey,
};

/// A signal of the new experiment.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NewSignal {
    /// Its key; of an arm's joint `position@elbow`, of a tip `tip[0]`.
    pub signal: String,
    /// Column or message path.
    pub column: String,
    /// The unit of what is recorded.
    pub unit: String,
    /// Least and greatest value in the recording, in that unit.
    pub range: Option<[f64; 2]>,
    /// Whether it was guessed.
    pub guessed: bool,
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
    pub(super) option: String,
}

impl TakenFor {
    pub(super) fn for_terminal(&self) -> String {
        match self.option.as_str() {
            "" => self.text.clone(),
            option => format!("{}; {option}", self.text),
        }
    }
}

impl Guessed {
    /// What is found; else the question is asked.
    pub(super) fn or_ask(&mut self, found: Result<NewSignal, NewError>) -> Option<NewSignal> {
        found.map_err(|question| self.questions.push(question)).ok()
    }

    /// What need not be there, where it is, in the unit that is `usual` where nothing says one.
    pub(super) fn maybe(&mut self, request: &Request, sources: &Sources, role: Role, usual: &str) {
        let signal = find(request, sources, role);
        let taken = |column: &String| self.signals.iter().any(|own| own.column == *column);
        match signal {
            Ok(Some(mut signal)) if !taken(&signal.column) => {
                if signal.unit.is_empty() {
                    signal.unit = usual.to_owned();
                }
                self.signals.push(signal);
            }
            Ok(_) => {}
            Err(question) => self.questions.push(question),
        }
    }
}

/// What has to be there.
pub(super) fn must(
    request: &Request,
    sources: &Sources,
    role: Role,
) -> Result<NewSignal, NewError> {
    find(request, sources, role)?.ok_or_else(|| {
        let why = format!("nothing is called like a {}", role.key());
        unsure(role, why, Vec::new(), sources)
    })
}

/// The signal as it was said, or by its name; its unit as said, or as the file
/// says; empty where nothing does.
pub(super) fn find(
    request: &Request,
    sources: &Sources,
    role: Role,
) -> Result<Option<NewSignal>, NewError> {
    if let Some(said) = request.said(role) {
        if sources.tables && sources.of(&said.column).is_none() {
            let why = format!("there is no column {:?}", said.column);
            return Err(unsure(role, why, Vec::new(), sources));
        }
        return Ok(Some(signal_said(role, said, sources)));
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
        several if !matches!(role, Role::JointTorque | Role::Temperature) => {
            let names: Vec<String> = several.iter().map(|(name, _)| (*name).to_owned()).collect();
            let why = format!("it can be {}", in_runs(&names).join(" or "));
            Err(unsure(role, why, names, sources))
        }
        _ => Ok(None),
    }
}

/// The signal as it was said; a path with functions at its end is checked when it is read.
pub(super) fn signal_said(role: Role, said: &Said, sources: &Sources) -> NewSignal {
    let mut signal = match sources.of(&said.column) {
        Some(column) => signal_of(role, column, said.unit.as_deref(), false),
        None => {
            let mut signal = signal_of(role, &ColumnSurvey::default(), None, false);
            signal.unit = said.unit.clone().unwrap_or_default();
            signal
        }
    };
    signal.column.clone_from(&said.column);
    signal
}

pub(super) fn signal_of(
    role: Role,
    column: &ColumnSurvey,
    said: Option<&str>,
    guessed: bool,
) -> NewSignal {
    let in_name = unit_in_name(&column.name).1;
    let unit = said.map(str::to_owned).or_else(|| column.unit.clone());
    let unit = unit.or_else(|| in_name.map(|unit| unit.name().to_owned()));
    NewSignal {
        signal: role.key().to_owned(),
        column: column.name.clone(),
        unit: unit.unwrap_or_default(),
        range: (column.numbers > 0).then_some([column.least, column.greatest]),
        guessed,
    }
}

pub(super) fn unsure(role: Role, why: String, choices: Vec<String>, sources: &Sources) -> NewError {
    let columns = sources.columns.iter().map(|own| own.name.clone());
    NewError::Unsure {
        role,
        joint: None,
        why,
        choices,
        columns: columns.collect(),
    }
}
