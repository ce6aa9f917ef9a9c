//! The lab: `ferntast lab …` and `ferntast challenge new`.

use std::path::PathBuf;

use ferntast_export::identified::{Program, Request as ExportRequest, identified};
use ferntast_identification::{JointType, comparison::Series};
use ferntast_lab::{
    experiment::Join,
    guess::Role,
    work::{self, AutoEvent, AutoOptions, InUnit, Opened, Request, Said},
};
use ferntast_studies::challenge::{self as challenges, Asked};
use pyo3::{prelude::*, types::PyAny};
use serde::Serialize;

use crate::{
    error::{failed, refused},
    interrupt,
};

/// What is told of one experiment.
#[derive(Serialize)]
struct Answer<T> {
    title: String,
    notes: Vec<String>,
    /// As the command line prints it.
    result: T,
    /// Curves, for drawing.
    series: Vec<Series>,
}

impl<T> Answer<T> {
    fn new(opened: Opened, result: T) -> Answer<T> {
        Answer {
            title: opened.experiment.title,
            notes: opened.notes,
            result,
            series: Vec::new(),
        }
    }
}

/// The JSON of `value`.
///
/// # Errors
///
/// It has none.
pub fn json(value: &impl Serialize) -> PyResult<String> {
    serde_json::to_string(value).map_err(failed)
}

/// The models of an experiment file, or of a session's joints, against their recordings;
/// with up to `points` points of each session to be drawn.
#[pyfunction]
#[pyo3(signature = (path, points))]
pub fn compare(py: Python<'_>, path: PathBuf, points: usize) -> PyResult<String> {
    interrupt::run(py, None, move |watch| {
        let mut answers: Vec<Answer<InUnit<_>>> = Vec::new();
        for opened in work::open(&path).map_err(refused)? {
            watch.step(0.0);
            let mut found = opened.compare_drawing(points).map_err(refused)?;
            let series = std::mem::take(&mut found.series);
            let result = opened.in_unit(found);
            answers.push(Answer {
                series,
                ..Answer::new(opened, result)
            });
        }
        json(&answers)
    })
}

/// Which effect each of the same models lacks.
#[pyfunction]
#[pyo3(signature = (path, progress))]
pub fn diagnose(
    py: Python<'_>,
    path: PathBuf,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<String> {
    interrupt::run(py, progress, move |watch| {
        let mut answers: Vec<Answer<InUnit<_>>> = Vec::new();
        let all = work::open(&path).map_err(refused)?;
        let count = all.len() as f64;
        for (before, opened) in all.into_iter().enumerate() {
            let mut step = |share: f64| watch.step((before as f64 + share) / count);
            let found = opened.diagnose_at_cutoffs(&mut step).map_err(refused)?;
            let result = opened.in_unit(found);
            answers.push(Answer::new(opened, result));
        }
        json(&answers)
    })
}

/// Formulas for what no effect of the catalogue explains in the same models; of a whole arm
/// for every joint. `seed` decides what chance is taken to be.
#[pyfunction]
#[pyo3(signature = (path, seed, progress))]
pub fn discover(
    py: Python<'_>,
    path: PathBuf,
    seed: u64,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<String> {
    interrupt::run(py, progress, move |watch| {
        if let Some(arm) = work::open_arm(&path).map_err(refused)? {
            let found = arm.discover(seed, &mut |share| watch.step(share));
            let result = InUnit {
                unit: arm.torque_unit(),
                result: found.map_err(refused)?,
            };
            return json(&[Answer {
                title: arm.experiment.title,
                notes: arm.notes,
                result,
                series: Vec::new(),
            }]);
        }
        let mut answers: Vec<Answer<InUnit<_>>> = Vec::new();
        let all = work::open(&path).map_err(refused)?;
        let count = all.len() as f64;
        for (before, opened) in all.into_iter().enumerate() {
            let mut step = |share: f64| watch.step((before as f64 + share) / count);
            let found = opened.discover(seed, &mut step).map_err(refused)?;
            let result = opened.in_unit(found);
            answers.push(Answer::new(opened, result));
        }
        json(&answers)
    })
}

/// Adds an effect to an experiment file's model, fits again, and writes the new file.
#[pyfunction]
#[pyo3(signature = (path, effect, bounds, output))]
pub fn add(
    py: Python<'_>,
    path: PathBuf,
    effect: String,
    bounds: Vec<String>,
    output: Option<PathBuf>,
) -> PyResult<String> {
    interrupt::run(py, None, move |watch| {
        let effect = work::own_effect(&effect, &bounds).map_err(refused)?;
        let opened = work::open_file(&path).map_err(refused)?;
        watch.step(0.0);
        let output = output.unwrap_or_else(|| work::beside(&path, effect.name()));
        let added = opened.add(&effect, &output).map_err(refused)?;
        let result = opened.in_unit(added);
        json(&Answer::new(opened, result))
    })
}

/// Writes what was identified for another program.
#[pyfunction]
#[pyo3(signature = (path, to, output, approximate))]
pub fn export(
    py: Python<'_>,
    path: PathBuf,
    to: String,
    output: Option<PathBuf>,
    approximate: bool,
) -> PyResult<String> {
    interrupt::run(py, None, move |watch| {
        let to: Program = to.parse().map_err(refused)?;
        watch.step(0.0);
        let told = identified(&ExportRequest {
            output: output.unwrap_or_else(|| to.beside(&path)),
            experiment: path,
            to,
            approximate,
            into: None,
            joint: None,
            servo_hz: None,
            compensated: None,
            force: false,
        });
        json(&told.map_err(refused)?)
    })
}

/// Diagnoses and adds until the model is complete, or what is left has no name.
#[pyfunction]
#[pyo3(signature = (path, folder, progress))]
pub fn auto(
    py: Python<'_>,
    path: PathBuf,
    folder: Option<PathBuf>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<String> {
    interrupt::run(py, progress, move |watch| {
        let mut title = String::new();
        let mut notes = Vec::new();
        let mut tell = |event: AutoEvent<'_>| match event {
            AutoEvent::Opened(opened) => {
                title.clone_from(&opened.experiment.title);
                notes.clone_from(&opened.notes);
                // Each diagnosis begins anew.
                watch.step(0.0);
            }
            AutoEvent::Share(share) => watch.step(share),
            AutoEvent::Diagnosed(..) | AutoEvent::Added(..) => {}
        };
        let options = AutoOptions {
            folder,
            ..AutoOptions::default()
        };
        let found = work::auto(&path, &options, &mut tell).map_err(refused)?;
        json(&Answer {
            title,
            notes,
            result: found,
            series: Vec::new(),
        })
    })
}

/// Makes an experiment file on recordings of one's own.
#[pyfunction]
#[pyo3(signature = (files, said, rate_hz, joint, join, output, force))]
#[allow(clippy::too_many_arguments, reason = "keywords of a Python function")]
pub fn new(
    py: Python<'_>,
    files: Vec<PathBuf>,
    said: Vec<(String, String)>,
    rate_hz: Option<f64>,
    joint: Option<String>,
    join: Option<String>,
    output: Option<PathBuf>,
    force: bool,
) -> PyResult<String> {
    let roles = [
        Role::Position,
        Role::MotorTorque,
        Role::JointTorque,
        Role::Temperature,
        Role::Time,
    ];
    let mut request = Request {
        files,
        rate_hz,
        output,
        force,
        ..Request::default()
    };
    for (key, text) in said {
        let role = roles.into_iter().find(|role| role.key() == key);
        let role = role.ok_or_else(|| refused(format!("{key:?} is no signal")))?;
        request.said.push((role, Said::parse(&text)));
    }
    request.joint = match joint.as_deref() {
        None => None,
        Some("revolute") => Some(JointType::Revolute),
        Some("prismatic") => Some(JointType::Prismatic),
        Some(other) => {
            return Err(refused(format!(
                "joint {other:?}: \"revolute\" or \"prismatic\""
            )));
        }
    };
    request.join = match join.as_deref() {
        None => None,
        Some("time") => Some(Join::Time),
        Some("row") => Some(Join::Row),
        Some(other) => return Err(refused(format!("join {other:?}: \"time\" or \"row\""))),
    };
    interrupt::run(py, None, move |_| {
        json(&work::make(&request).map_err(refused)?)
    })
}

/// The effects of the catalogue, of joints and of contacts.
#[pyfunction]
pub fn effects() -> PyResult<String> {
    json(&ferntast_identification::catalogue())
}

/// Makes a recording with a hidden effect in `folder`; gives its experiment file.
#[pyfunction]
#[pyo3(signature = (folder, contact, seed, strength, hide, sessions))]
pub fn challenge(
    py: Python<'_>,
    folder: PathBuf,
    contact: bool,
    seed: u64,
    strength: f64,
    hide: Vec<String>,
    sessions: Option<usize>,
) -> PyResult<PathBuf> {
    let asked = Asked {
        seed,
        strength,
        hide,
        sessions,
    };
    interrupt::run(py, None, move |_| {
        challenges::make(&folder, contact, &asked).map_err(refused)
    })
}
