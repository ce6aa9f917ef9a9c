//! What files that somebody brought hold, and which signals that may be.

use std::path::PathBuf;

use ferntast_identification::JointType;
use serde::Serialize;

use super::{
    NewError, chain::ArmChain, new::kind, new_signal::NewSignal, request::Request, signals::guess,
    sources::Sources,
};
use crate::{guess::unit_in_name, table::ColumnSurvey};

/// What has to be asked.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Question {
    /// The signal's key; of an arm's joint `position@elbow`.
    pub signal: String,
    /// Why it is not clear.
    pub why: String,
    /// What it can be, best first, `COLUMN` or `COLUMN:UNIT`; may be empty.
    pub choices: Vec<String>,
}

/// What files hold.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Look {
    /// Recordings, each with the files that it is joined from.
    pub recordings: Vec<Vec<PathBuf>>,
    /// Columns of tables with what is in them, units as their names say where the file says
    /// none; of messages the paths of their numbers.
    pub columns: Vec<ColumnSurvey>,
    /// Whether these are tables.
    pub tables: bool,
    /// Whether the tables name their columns, or names were given.
    pub named: bool,
    /// Signals as far as they are clear.
    pub signals: Vec<NewSignal>,
    /// Kind of joint, by the units; of an arm that of its first joint.
    pub joint: JointType,
    /// The arm's joints, where it is about one.
    pub arm: Option<ArmChain>,
    /// What is not clear.
    pub questions: Vec<Question>,
    /// What was taken for granted.
    pub warnings: Vec<String>,
}

/// Looks at files as [`make`](super::make) does, and writes nothing.
///
/// # Errors
///
/// [`NewError`]: a file cannot be read.
pub fn look(request: &Request) -> Result<Look, NewError> {
    if request.files.is_empty() {
        return Err(NewError::NoFile);
    }
    let chain = request.arm.as_ref().map(ArmChain::read).transpose()?;
    let mut sources = Sources::look(request, chain.as_ref())?;
    let guessed = guess(request, &sources, chain.as_ref());
    let questions = guessed
        .questions
        .into_iter()
        .filter_map(|error| match error {
            NewError::Unsure {
                role,
                joint,
                why,
                choices,
                ..
            } => Some(Question {
                signal: match joint {
                    Some(joint) => format!("{}@{joint}", role.key()),
                    None => role.key().to_owned(),
                },
                why,
                choices,
            }),
            _ => None,
        });
    for column in &mut sources.columns {
        let in_name = unit_in_name(&column.name).1;
        let in_name = in_name.map(|unit| unit.name().to_owned());
        column.unit = column.unit.take().or(in_name);
    }
    Ok(Look {
        questions: questions.collect(),
        joint: kind(request, chain.as_ref(), &guessed.signals),
        arm: chain,
        signals: guessed.signals,
        warnings: guessed.taken.into_iter().map(|taken| taken.text).collect(),
        recordings: sources.recordings,
        columns: sources.columns,
        tables: sources.tables,
        named: sources.named,
    })
}
