//! Many experiments of the lab, each completed step by step.

use std::{
    fmt::Display,
    fs, io,
    path::{Path, PathBuf},
    sync::atomic::AtomicBool,
};

use ferntast_lab::work::{self, AutoOptions, WorkError};
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use crate::{
    parallel,
    shard::{Placed, Shard, Study},
};

/// `ferntast lab auto` of every experiment file in a folder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LabFolder {
    /// The experiment files, in the order of their names.
    pub experiments: Vec<PathBuf>,
    /// Folder of the new experiment files.
    pub output: PathBuf,
    /// Also take effects that help in part.
    pub partial: bool,
    /// Leave out the last verdict at other cut-offs of the filter.
    pub quick: bool,
    /// Write over files that are there.
    pub force: bool,
}

/// What came of one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Completed {
    /// Its verdict; none where it cannot be used.
    pub verdict: Option<String>,
    /// What was added, in order.
    pub added: Vec<String>,
    /// What `ferntast lab auto --json` says of it.
    json: Option<String>,
    /// Why it cannot be used.
    pub error: Option<String>,
}

/// What is told of one.
#[derive(Debug, Serialize)]
pub struct Told {
    /// The experiment file.
    pub experiment: PathBuf,
    /// Why it cannot be used; else `null`.
    pub error: Option<String>,
    /// What `ferntast lab auto --json` says of it.
    pub result: Option<Box<RawValue>>,
}

impl Study for LabFolder {
    const KIND: &'static str = "lab_auto";
    type Answer = Completed;
}

/// The experiment files in `folder`, by name.
///
/// # Errors
///
/// It cannot be read.
pub fn experiments(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.extension().is_some_and(|end| end == "toml") {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

impl LabFolder {
    /// Completes the experiments that are in `shard`, on all processors, until `stop`; `done`
    /// is called once an experiment, from any thread. One that cannot be used says so, and
    /// the others go on.
    pub fn run(
        &self,
        shard: Shard,
        stop: &AtomicBool,
        done: impl Fn() + Sync,
    ) -> Vec<Placed<Completed>> {
        let files = shard.part_of(self.experiments.clone());
        let answers = parallel::map_until(&files, stop, |_, (place, path)| {
            let value = self.complete(path).unwrap_or_else(|error| Completed {
                verdict: None,
                added: Vec::new(),
                json: None,
                error: Some(error),
            });
            done();
            Ok::<_, std::convert::Infallible>(Placed {
                place: *place,
                value,
            })
        });
        let Ok(answers) = answers;
        answers.into_iter().map(|(_, answer)| answer).collect()
    }

    fn complete(&self, path: &Path) -> Result<Completed, String> {
        let options = AutoOptions {
            folder: Some(self.output.clone()),
            partial: self.partial,
            quick: self.quick,
            force: self.force,
        };
        let refuse = |error: WorkError| error.to_string();
        if let Some(found) = work::auto_arm(path, &options, &mut |_| {}).map_err(refuse)? {
            let added = found.steps.iter().map(|own| match &own.joint {
                Some(joint) => format!("{}@{joint}", own.effect),
                None => own.effect.clone(),
            });
            return completed(found.verdict.name(), added.collect(), &found);
        }
        let found = work::auto(path, &options, &mut |_| {}).map_err(refuse)?;
        let added = found.steps.iter().map(|own| own.added.effect.clone());
        completed(found.verdict.name(), added.collect(), &found)
    }

    /// What is told of each, in their order.
    ///
    /// # Errors
    ///
    /// A part holds what is no JSON.
    pub fn total(&self, answers: &[Placed<Completed>]) -> Result<Vec<Told>, serde_json::Error> {
        let told = |own: &Placed<Completed>| {
            let result = own.value.json.clone().map(RawValue::from_string);
            Ok(Told {
                experiment: self.path(own.place),
                error: own.value.error.clone(),
                result: result.transpose()?,
            })
        };
        answers.iter().map(told).collect()
    }

    /// The experiment at `place`.
    pub fn path(&self, place: u64) -> PathBuf {
        let path = self.experiments.get(place as usize);
        path.cloned().unwrap_or_default()
    }
}

fn completed(
    verdict: &(impl Display + ?Sized),
    added: Vec<String>,
    found: &impl Serialize,
) -> Result<Completed, String> {
    Ok(Completed {
        verdict: Some(verdict.to_string()),
        added,
        json: Some(serde_json::to_string(found).map_err(|error| error.to_string())?),
        error: None,
    })
}
