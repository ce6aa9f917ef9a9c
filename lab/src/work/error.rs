//! Why work on an experiment does not go on.

use std::path::PathBuf;

use ferntast_identification::PrepareError;

use crate::{
    experiment::{ExperimentError, WriteError},
    guess::Role,
    recording::LoadError,
    table::TableError,
};

/// Why work on an experiment does not go on.
#[derive(Debug, thiserror::Error)]
pub enum WorkError {
    /// The experiment file cannot be used.
    #[error(transparent)]
    Experiment(#[from] ExperimentError),
    /// A recording cannot be used.
    #[error(transparent)]
    Load(Box<LoadError>),
    /// A table cannot be used.
    #[error(transparent)]
    Table(Box<TableError>),
    /// The data or the model lack something.
    #[error("{title}: {source}")]
    Prepare {
        /// The experiment.
        title: String,
        /// What is lacking.
        source: Box<PrepareError>,
    },
    /// It is about an arm where it has to be about a joint or a contact.
    #[error(
        "{title}: it is about a whole arm, and this goes with one joint; see ferntast lab --help"
    )]
    WholeArm {
        /// The experiment.
        title: String,
    },
    /// The data or the model of an arm lack something.
    #[error("{title}: {source}")]
    Arm {
        /// The experiment.
        title: String,
        /// What is lacking.
        source: Box<ferntast_identification::arm::ArmError>,
    },
    /// The new experiment file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A new file would lie over another one.
    #[error("{path} exists already: choose another name, or --force to write over it")]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// The experiment file is another than the one that was looked at.
    #[error("{path} was changed meanwhile: open it again, and say once more what is to be changed")]
    Changed {
        /// The file.
        path: PathBuf,
    },
    /// A file cannot be written.
    #[error("cannot write {path}: {source}")]
    File {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The recording holds no joint.
    #[error("{path}: no joint in it")]
    NoJoint {
        /// The recording.
        path: PathBuf,
    },
    /// The recording says nothing of a twin.
    #[error(
        "{path}: nothing of a twin in it: record a session that runs with --twin EXPERIMENT.toml"
    )]
    NoTwin {
        /// The recording.
        path: PathBuf,
    },
    /// The twin in the recording is not that of the experiment.
    #[error("{path}: {reason}; name the experiment that the twin was started with")]
    OtherModel {
        /// The recording.
        path: PathBuf,
        /// What does not go together.
        reason: String,
    },
    /// What the twin said cannot be read.
    #[error("{path}: {reason}")]
    Twin {
        /// The recording.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// A custom effect is not described as it has to be.
    #[error("{0}")]
    OwnEffect(String),
}

impl From<LoadError> for WorkError {
    fn from(error: LoadError) -> WorkError {
        WorkError::Load(Box::new(error))
    }
}

impl From<TableError> for WorkError {
    fn from(error: TableError) -> WorkError {
        WorkError::Table(Box::new(error))
    }
}

/// Why there is no new experiment file.
#[derive(Debug, thiserror::Error)]
pub enum NewError {
    /// No file was given.
    #[error("name a recording: a table (.csv, …), an .mcap file, or a folder")]
    NoFile,
    /// A folder without recordings.
    #[error("{}: neither .mcap files nor tables in it", path.display())]
    EmptyFolder {
        /// The folder.
        path: PathBuf,
    },
    /// Tables and messages together.
    #[error("tables and MCAP recordings cannot be in one experiment: name one kind")]
    Mixed,
    /// The URDF of an arm cannot be used.
    #[error("{}: {reason}", path.display())]
    Urdf {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// The user has to say which column is a signal.
    #[error("which column is the {}? {why}; say {} {}{}; columns: {}", called(*role, joint.as_deref()), option(*role), form(joint.is_some()), suggested(choices), in_runs(columns).join(", "))]
    Unsure {
        /// The signal.
        role: Role,
        /// Of an arm, whose.
        joint: Option<String>,
        /// Why it is not clear.
        why: String,
        /// What it can be, best first; may be empty.
        choices: Vec<String>,
        /// The columns that there are.
        columns: Vec<String>,
    },
    /// The recordings cannot be used, or the file not be written.
    #[error(transparent)]
    Work(#[from] WorkError),
}

/// A signal as a question calls it.
fn called(role: Role, joint: Option<&str>) -> String {
    match joint {
        Some(joint) => format!("{} of {joint}", role.key()),
        None => role.key().to_owned(),
    }
}

/// What the option takes.
const fn form(of_arm: bool) -> &'static str {
    match of_arm {
        true => "a COLUMN for each joint with commas between, or one name with {joint} in it",
        false => "COLUMN or COLUMN:UNIT",
    }
}

/// The option that says which column a signal is.
fn option(role: Role) -> String {
    match role {
        Role::TipX | Role::TipY => "--tip COLUMN,COLUMN, each as".to_owned(),
        // There may be none.
        Role::Time => "--rate HZ where there is none, or --time".to_owned(),
        _ => format!("--{}", role.key().replace('_', "-")),
    }
}

fn suggested(choices: &[String]) -> String {
    match choices {
        [] => String::new(),
        [first, _, _, _, ..] => format!(" (as {first})"),
        choices => format!(" ({})", choices.join(" or ")),
    }
}

/// Names, of arrays (`q[0]`, `q[1]`, `q[2]`) the first and the last: `q[0] … q[2]`.
pub fn in_runs(names: &[String]) -> Vec<String> {
    let stem = |name: &str| Some(name.rsplit_once('[')?.0.to_owned());
    let runs = names.chunk_by(|a, b| stem(a).is_some_and(|own| stem(b) == Some(own)));
    let told = runs.flat_map(|run| match run {
        [first, _, .., last] => vec![format!("{first} … {last}")],
        few => few.to_vec(),
    });
    told.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_of_an_array_are_told_as_a_run() {
        let names = ["t", "q[0]", "q[1]", "q[2]", "tau[0]", "tau[1]", "i"].map(str::to_owned);
        let told = ["t", "q[0] … q[2]", "tau[0]", "tau[1]", "i"];
        assert_eq!(in_runs(&names), told);
    }
}
