//! What the lab identified, for other programs: URDF, SDF, MuJoCo, the driver of Universal
//! Robots, and this project's own arms.
//!
//! * [`model`]: joints, friction, armatures and links, with standard errors,
//! * [`program`]: who it goes to, and which effects can be said there,
//! * [`unsaid`]: what is lost, and what it amounts to,
//! * a file for each form.
//!
//! Nothing is left out or approximated in silence: an effect that a form has no words for is
//! told with its RMS torque and with what the model errs by without it. What can be said is
//! written as the whole model has it, or, where that is asked for, as it fits best without
//! the rest.

mod error;
mod ferntast;
mod model;
mod mujoco;
mod program;
mod sdf;
mod unsaid;
mod ur;
mod urdf;

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

use serde::Serialize;

pub use error::IdentifiedError;
use model::Model;
pub use program::Program;
pub use unsaid::Unsaid;

/// What is asked for.
#[derive(Clone, Debug)]
pub struct Request {
    /// Experiment file.
    pub experiment: PathBuf,
    /// Who it goes to.
    pub to: Program,
    /// The file that is written.
    pub output: PathBuf,
    /// Whether what can be said is fitted anew without the rest.
    pub approximate: bool,
    /// URDF: the file that the friction goes into, in place of the experiment's.
    pub into: Option<PathBuf>,
    /// What the joint is called there, where the experiment is about one.
    pub joint: Option<String>,
    /// MuJoCo: servos of position of this bandwidth \[Hz\] in place of torques.
    pub servo_hz: Option<f64>,
    /// Universal Robots: the experiment on a recording under the robot's compensation.
    pub compensated: Option<PathBuf>,
    /// Whether files that are there are written over.
    pub force: bool,
}

/// What was written, and what could not be said.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Told {
    /// Who it is for.
    pub to: Program,
    /// The files.
    pub files: Vec<PathBuf>,
    /// Whether what is said was fitted anew without the rest.
    pub approximated: bool,
    /// Errors by joint.
    pub joints: BTreeMap<String, Errors>,
    /// Effects that could not be said.
    pub unsaid: Vec<Unsaid>,
    /// What else there is to know.
    pub notes: Vec<String>,
}

/// What a joint's model errs by \[Nm\] or \[N\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Errors {
    /// The whole model, on rows left out.
    pub held_out: f64,
    /// The whole model, on the rows fitted.
    pub train: f64,
    /// On the rows fitted, with only what is said, its values as the whole model has them.
    pub said_alone: f64,
    /// The same fitted anew; none where all is said.
    pub said_refitted: Option<f64>,
}

/// Fits the experiment's model and writes it for a program.
///
/// # Errors
///
/// [`IdentifiedError`]; nothing is written then.
pub fn identified(request: &Request) -> Result<Told, IdentifiedError> {
    let model = Model::of(request)?;
    let mut notes = model.notes();
    let files = match request.to {
        Program::Urdf => vec![(
            request.output.clone(),
            urdf::text(&model, request.into.as_deref(), &mut notes)?,
        )],
        Program::Sdf => vec![(request.output.clone(), sdf::text(&model, &mut notes))],
        Program::Mujoco => vec![(
            request.output.clone(),
            mujoco::text(&model, request.servo_hz, &mut notes),
        )],
        Program::Ur => vec![(
            request.output.clone(),
            ur::text(&model, request, &mut notes)?,
        )],
        Program::Ferntast => ferntast::files(&model, &request.output, &mut notes)?,
    };
    if !request.force {
        for (path, _) in &files {
            ferntast_lab::work::refuse_existing(path)?;
        }
    }
    for (path, text) in &files {
        write(path, text)?;
    }
    Ok(Told {
        to: request.to,
        files: files.into_iter().map(|(path, _)| path).collect(),
        approximated: model.approximate && model.joints.iter().any(|own| own.is_approximated()),
        joints: model.errors(),
        unsaid: unsaid::all(&model),
        notes,
    })
}

fn write(path: &Path, text: &str) -> Result<(), IdentifiedError> {
    fs::write(path, text).map_err(|source| IdentifiedError::File {
        path: path.to_owned(),
        source,
    })
}
