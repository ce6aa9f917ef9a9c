//! What changed between recordings, or between the dates of one experiment.
//!
//! The same model is fitted to each: all effects that any of the experiments has, so
//! that parameters can be held beside each other. A change counts where it exceeds what
//! both ends are uncertain by.

mod arm;
mod changes;
mod joints;
mod parts;
mod same_units;

use std::{collections::BTreeMap, fmt::Display};

use ferntast_identification::{
    ModelSpec, Verdict, compare, comparison::Comparison, diagnose, fit::Parameter,
};
use serde::Serialize;

use super::{Opened, WorkError, units};
pub use arm::trends_of_arm;
use changes::{courses, turns};
use parts::{Part, days, parts};
pub use same_units::UnitIn;

/// How a joint, or a contact, changed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Trend {
    /// The joint, or the first experiment.
    pub title: String,
    /// Unit of torques or forces.
    pub unit: &'static str,
    /// Effects of the model that is fitted to all.
    pub effects: Vec<String>,
    /// The recordings or dates, in the order given.
    pub points: Vec<Point>,
    /// Parameter by parameter.
    pub parameters: Vec<Course>,
    /// Effects that came or went.
    pub came_or_went: Vec<Turn>,
    /// What has to be known besides.
    pub notes: Vec<String>,
}

/// One recording, or the sessions of one date.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Point {
    /// Its name.
    pub name: String,
    /// Days since the first one; `None` where recordings carry no date.
    pub days: Option<f64>,
    /// Sessions in it.
    pub sessions: usize,
    /// Mean temperature \[degC\], where it was recorded.
    pub temperature: Option<f64>,
    /// Error on rows left out.
    pub held_out: f64,
    /// The parameters.
    pub parameters: BTreeMap<String, Parameter>,
    /// Whether something is missing; `None` where that was not asked for.
    pub verdict: Option<Verdict>,
    /// The effect that is named as missing.
    pub missing: Option<String>,
}

/// A parameter over the recordings.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Course {
    /// Its name.
    pub name: String,
    /// The effect that it belongs to.
    pub effect: String,
    /// Its unit.
    pub unit: String,
    /// Last less first.
    pub change: Option<Change>,
    /// From each recording to the next one that has it, in order.
    pub steps: Vec<Change>,
    /// Probability that the values differ as much by chance, all of them held against
    /// their mean.
    pub p_value: Option<f64>,
    /// Whether they differ by more than chance makes them: below 5 %.
    pub changes: bool,
}

/// A difference between two recordings.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Change {
    /// The earlier one.
    pub from: String,
    /// The later one.
    pub to: String,
    /// Later less earlier.
    pub change: f64,
    /// Its standard error, by those of both ends.
    pub std_error: f64,
    /// Probability of one as large by chance; of one difference, not of all that are looked at.
    pub p_value: f64,
    /// Whether the change exceeds the errors of both ends: p below 5 %.
    pub exceeds_errors: bool,
}

/// An effect that came or went.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Turn {
    /// Its id or name.
    pub effect: String,
    /// The recording before, in which it was as it had been.
    pub from: String,
    /// The recording since which it is otherwise.
    pub to: String,
    /// Whether it came; else it went.
    pub came: bool,
    /// Whether that is said by the diagnosis (named as missing); else by its
    /// parameters in the model (away from zero, or not).
    pub by_diagnosis: bool,
}

/// What is said where a point has few sessions.
const BY_BLOCKS: &str = "of fewer than three sessions the standard errors are by blocks of time: how parameters vary \
                         from session to session is not in them";

/// Why there is no trend.
#[derive(Debug, thiserror::Error)]
pub enum TrendError {
    /// One recording of one session cannot be held against anything.
    #[error(
        "{0}: one session only: give several experiments or recordings, or one of several sessions"
    )]
    One(String),
    /// Files have different numbers of joints.
    #[error("the files have {0} and {1} joints: give such as have the same")]
    Joints(usize, usize),
    /// Arms have other joints.
    #[error("the files are of other arms: one has the joints {0}, another one {1}")]
    Arms(String, String),
    /// Numbers of one file are no numbers of another's unit.
    #[error(
        "{what}: {} in {}, and {} in {}: only what has the same unit can be held beside each other; \
         state the same unit in both, or leave one out",
        first.unit, first.file, other.unit, other.file
    )]
    Units {
        /// Of what: torques, the joint, a signal, a parameter.
        what: String,
        /// As it is in the first file.
        first: UnitIn,
        /// As it is in another one.
        other: UnitIn,
    },
    /// Recordings of sessions in which no joint moves in all.
    #[error("no joint moves in all of the recordings ({0}): give such as are of the same joint")]
    NoJoint(String),
    /// The model cannot be fitted to one of them.
    #[error(transparent)]
    Work(#[from] WorkError),
}

/// The trend of each joint over `files`, each of which holds one experiment a joint; of
/// recordings of sessions, of those joints that move in all.
/// Every part is diagnosed, too, if `diagnoses`; `progress` is called with the share
/// done, 0 … 1.
///
/// # Errors
///
/// [`TrendError`].
pub fn trends(
    files: &[Vec<Opened>],
    diagnoses: bool,
    progress: &mut dyn FnMut(f64),
) -> Result<Vec<Trend>, TrendError> {
    let (joints, notes) = joints::of_each(files)?;
    let share = 1.0 / joints.len() as f64;
    let each = joints.iter().enumerate().map(|(number, own)| {
        trend(own, diagnoses, &mut |done| {
            progress(share * (number as f64 + done))
        })
    });
    let mut trends = each.collect::<Result<Vec<Trend>, TrendError>>()?;
    if let Some(first) = trends.first_mut() {
        first.notes.extend(notes);
    }
    Ok(trends)
}

fn trend(
    all: &[&Opened],
    diagnoses: bool,
    progress: &mut dyn FnMut(f64),
) -> Result<Trend, TrendError> {
    same_units::of_experiments(all)?;
    let parts = parts(all)?;
    let Some(first) = all.first() else {
        return Err(TrendError::One(String::new()));
    };
    let model = model_of_all(all);
    let mut notes = Vec::new();
    let mut points = Vec::new();
    for (number, part) in parts.iter().enumerate() {
        let mut point = fitted(part, &model, &mut notes)?;
        point.days = days(&parts, part);
        if diagnoses {
            let found = diagnose(&part.data, &model, &mut |_| ());
            if let Ok(found) = found {
                point.verdict = Some(found.verdict);
                point.missing = found.candidates.first().map(|own| own.effect.clone());
            }
        }
        points.push(point);
        progress((number as f64 + 1.0) / parts.len() as f64);
    }
    same_units::of_parameters(&parts, &points)?;
    if points.iter().any(|point| point.sessions < 3) {
        notes.push(BY_BLOCKS.to_owned());
    }
    Ok(Trend {
        title: first.experiment.title.clone(),
        unit: first.torque_unit(),
        effects: model
            .effects
            .iter()
            .map(|own| own.name().to_owned())
            .collect(),
        parameters: courses(&points),
        came_or_went: turns(&points),
        points,
        notes,
    })
}

/// All effects that any of the experiments has; the rest as the first one has it.
fn model_of_all(all: &[&Opened]) -> ModelSpec {
    let mut models = all.iter().map(|own| &own.experiment.model);
    let Some(mut model) = models.next().cloned() else {
        return ModelSpec {
            inertia: ferntast_identification::Inertia::Fit,
            gear_ratio: None,
            effects: Vec::new(),
        };
    };
    for other in models {
        for effect in &other.effects {
            if !model.effects.iter().any(|own| own.name() == effect.name()) {
                model.effects.push(effect.clone());
            }
        }
    }
    model
}

/// What was found by the model of all; where that cannot be fitted, by the part's own, which is noted.
fn or_by_its_own<T>(
    name: &str,
    of_all: Result<T, impl Display>,
    own: impl FnOnce() -> Result<T, WorkError>,
    notes: &mut Vec<String>,
) -> Result<T, WorkError> {
    of_all.or_else(|why| {
        let own = own()?;
        notes.push(format!(
            "{name}: fitted by its own model, since that of all cannot be: {why}"
        ));
        Ok(own)
    })
}

/// The model fitted to a part; where that cannot be, the experiment's own.
fn fitted(
    part: &Part<'_, Opened>,
    model: &ModelSpec,
    notes: &mut Vec<String>,
) -> Result<Point, WorkError> {
    let own = || {
        let own = &part.opened.experiment.model;
        compare(&part.data, own).map_err(|error| part.opened.refuse(error))
    };
    let of_all = compare(&part.data, model);
    let mut found: Comparison = or_by_its_own(&part.name, of_all, own, notes)?;
    units::in_units_of(&part.opened.experiment, &mut found.parameters);
    let temperatures = part
        .data
        .sessions
        .iter()
        .filter_map(|own| own.temperature.as_ref());
    let (sum, count) = temperatures
        .flatten()
        .fold((0.0, 0_usize), |(sum, count), value| {
            (sum + value, count + 1)
        });
    Ok(Point {
        name: part.name.clone(),
        days: None,
        sessions: part.data.sessions.len(),
        temperature: (count > 0).then(|| sum / count as f64),
        held_out: found.rms.held_out,
        parameters: found.parameters,
        verdict: None,
        missing: None,
    })
}
