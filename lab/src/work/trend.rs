//! What changed between recordings, or between the dates of one experiment.
//!
//! The same model is fitted to each: all effects that any of the experiments has, so
//! that parameters can be held beside each other. A change counts where it exceeds what
//! both ends are uncertain by.

use std::collections::BTreeMap;

use ferntast_identification::{
    Dataset, ModelSpec, Verdict, compare, comparison::Comparison, diagnose, fit::Parameter,
    numerics::statistics::f_tail,
};
use serde::Serialize;

use super::{Opened, WorkError, units};

/// A pause \[s\] between sessions after which another date begins.
const ANOTHER_DATE: f64 = 12.0 * 3600.0;
/// A change counts where chance alone makes one as large less often than this.
const SIGNIFICANCE: f64 = 0.05;

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
    /// The model cannot be fitted to one of them.
    #[error(transparent)]
    Work(#[from] WorkError),
}

/// One part of the data, and the experiment that it is of.
struct Part<'a> {
    name: String,
    start: Option<f64>,
    opened: &'a Opened,
    data: Dataset,
}

/// The trend of each joint over `files`, each of which holds one experiment a joint.
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
    let joints = files.first().map_or(0, Vec::len);
    if let Some(other) = files.iter().find(|file| file.len() != joints) {
        return Err(TrendError::Joints(joints, other.len()));
    }
    let of_joint = |joint: usize| {
        let own: Vec<&Opened> = files.iter().filter_map(|file| file.get(joint)).collect();
        let share = 1.0 / joints as f64;
        trend(&own, diagnoses, &mut |done| {
            progress(share * (joint as f64 + done))
        })
    };
    (0..joints).map(of_joint).collect()
}

fn trend(
    all: &[&Opened],
    diagnoses: bool,
    progress: &mut dyn FnMut(f64),
) -> Result<Trend, TrendError> {
    let parts = match all {
        [one] => dates(one)?,
        several => several.iter().map(|own| whole(own)).collect(),
    };
    let Some(first) = all.first() else {
        return Err(TrendError::One(String::new()));
    };
    let model = model_of_all(all);
    let mut notes = Vec::new();
    let mut points = Vec::new();
    let begin = parts.iter().find_map(|part| part.start);
    for (number, part) in parts.iter().enumerate() {
        let mut point = fitted(part, &model, &mut notes)?;
        point.days = part
            .start
            .zip(begin)
            .map(|(own, begin)| (own - begin) / 86_400.0);
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
    if points.iter().any(|point| point.sessions < 3) {
        notes.push(
            "of fewer than three sessions the standard errors are by blocks of time: how parameters vary from session to session is not in them".to_owned(),
        );
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

/// A whole experiment as one part.
fn whole<'a>(opened: &&'a Opened) -> Part<'a> {
    let path = opened.experiment.path.as_ref();
    let recording = opened.experiment.recordings.first();
    let name = path.or(recording).map_or_else(
        || opened.experiment.title.clone(),
        |path| {
            let name = path.file_name().unwrap_or(path.as_os_str());
            name.to_string_lossy().into_owned()
        },
    );
    Part {
        name,
        start: opened.date,
        opened,
        data: opened.dataset.clone(),
    }
}

/// The dates of one experiment; of one date its sessions.
fn dates(opened: &Opened) -> Result<Vec<Part<'_>>, TrendError> {
    let sessions = &opened.dataset.sessions;
    let mut groups: Vec<Vec<usize>> = Vec::new();
    let mut end = f64::NEG_INFINITY;
    for (at, session) in sessions.iter().enumerate() {
        match groups.last_mut() {
            Some(last) if session.start - end < ANOTHER_DATE => last.push(at),
            _ => groups.push(vec![at]),
        }
        end = session.start + session.period * session.len() as f64;
    }
    if groups.len() < 2 {
        groups = (0..sessions.len()).map(|at| vec![at]).collect();
    }
    if groups.len() < 2 {
        return Err(TrendError::One(opened.experiment.title.clone()));
    }
    let part = |group: &Vec<usize>| {
        let own: Vec<_> = group
            .iter()
            .filter_map(|at| sessions.get(*at).cloned())
            .collect();
        let start = own.first().map_or(0.0, |session| session.start);
        let name = own
            .first()
            .map_or_else(String::new, |session| session.name.clone());
        Part {
            name,
            start: Some(opened.date.unwrap_or(0.0) + start),
            opened,
            data: Dataset {
                sessions: own
                    .into_iter()
                    .map(|mut session| {
                        session.start -= start;
                        session
                    })
                    .collect(),
                held_out: Vec::new(),
                ..opened.dataset.clone()
            },
        }
    };
    Ok(groups.iter().map(part).collect())
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

/// The model fitted to a part; where that cannot be, the experiment's own.
fn fitted(part: &Part<'_>, model: &ModelSpec, notes: &mut Vec<String>) -> Result<Point, WorkError> {
    let of_all = compare(&part.data, model);
    let mut found: Comparison = match of_all {
        Ok(found) => found,
        Err(why) => {
            let own = &part.opened.experiment.model;
            let found = compare(&part.data, own).map_err(|error| part.opened.refuse(error))?;
            notes.push(format!(
                "{}: fitted by its own model, since that of all cannot be: {why}",
                part.name
            ));
            found
        }
    };
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

/// Every parameter over the points.
fn courses(points: &[Point]) -> Vec<Course> {
    let mut names: Vec<&String> = points
        .iter()
        .flat_map(|own| own.parameters.keys())
        .collect();
    names.sort();
    names.dedup();
    let course = |name: &String| {
        let there: Vec<(&str, &Parameter)> = points
            .iter()
            .filter_map(|own| Some((own.name.as_str(), own.parameters.get(name)?)))
            .collect();
        let (_, first) = there.first()?;
        let steps = there.windows(2).filter_map(|pair| match pair {
            [from, to] => difference(*from, *to),
            _ => None,
        });
        let p_value = spread(&there);
        Some(Course {
            name: name.clone(),
            effect: first.effect.clone(),
            unit: first.unit.clone(),
            change: match there.as_slice() {
                [first, .., last] => difference(*first, *last),
                _ => None,
            },
            steps: steps.collect(),
            p_value,
            changes: p_value.is_some_and(|p| p < SIGNIFICANCE),
        })
    };
    names.into_iter().filter_map(course).collect()
}

/// Degrees of freedom that the interval of a parameter was made with, at least.
const FREEDOM: f64 = 5.0;

fn difference(from: (&str, &Parameter), to: (&str, &Parameter)) -> Option<Change> {
    let (a, b) = (from.1.std_error?, to.1.std_error?);
    let (change, std_error) = (to.1.value - from.1.value, a.hypot(b));
    let p_value = f_tail((change / std_error.max(1e-300)).powi(2), 1.0, FREEDOM);
    Some(Change {
        from: from.0.to_owned(),
        to: to.0.to_owned(),
        change,
        std_error,
        p_value,
        exceeds_errors: p_value < SIGNIFICANCE,
    })
}

/// Probability that values around their weighted mean lie as far apart by chance.
fn spread(there: &[(&str, &Parameter)]) -> Option<f64> {
    let weighted = there.iter().map(|(_, own)| {
        let error = own.std_error?;
        (error > 0.0).then(|| (own.value, error.powi(-2)))
    });
    let weighted: Vec<(f64, f64)> = weighted.collect::<Option<_>>()?;
    let freedom = weighted.len().checked_sub(1).filter(|own| *own > 0)? as f64;
    let weights: f64 = weighted.iter().map(|own| own.1).sum();
    let mean = weighted
        .iter()
        .map(|(value, weight)| value * weight)
        .sum::<f64>()
        / weights;
    let square: f64 = weighted
        .iter()
        .map(|(value, weight)| weight * (value - mean).powi(2))
        .sum();
    Some(f_tail(square / freedom, freedom, FREEDOM * (freedom + 1.0)))
}

/// Effects that came or went: named as missing since, or not any more; in the model,
/// away from zero since, or not any more, by a change that exceeds its errors.
fn turns(points: &[Point]) -> Vec<Turn> {
    let mut turns = Vec::new();
    for pair in points.windows(2) {
        let [from, to] = pair else { continue };
        let mut turn = |effect: &str, came: bool, by_diagnosis: bool| {
            turns.push(Turn {
                effect: effect.to_owned(),
                from: from.name.clone(),
                to: to.name.clone(),
                came,
                by_diagnosis,
            });
        };
        let asked = from.verdict.is_some() && to.verdict.is_some();
        if asked && from.missing != to.missing {
            from.missing
                .iter()
                .for_each(|effect| turn(effect, false, true));
            to.missing
                .iter()
                .for_each(|effect| turn(effect, true, true));
        }
        let mut effects: Vec<&str> = from
            .parameters
            .values()
            .map(|own| own.effect.as_str())
            .collect();
        effects.sort_unstable();
        effects.dedup();
        for effect in effects {
            let own = from
                .parameters
                .iter()
                .filter(|(_, own)| own.effect == effect);
            let both: Vec<(&Parameter, &Parameter)> = own
                .filter_map(|(name, own)| Some((own, to.parameters.get(name)?)))
                .collect();
            let is_there = |of: &dyn Fn(&(&Parameter, &Parameter)) -> bool| both.iter().any(of);
            let (before, after) = (
                is_there(&|pair| is_away_from_zero(pair.0)),
                is_there(&|pair| is_away_from_zero(pair.1)),
            );
            let changed = both
                .iter()
                .any(|(a, b)| difference(("", a), ("", b)).is_some_and(|own| own.exceeds_errors));
            if before != after && changed {
                turn(effect, after, false);
            }
        }
    }
    turns
}

fn is_away_from_zero(parameter: &Parameter) -> bool {
    parameter
        .interval_95
        .is_some_and(|[low, high]| low > 0.0 || high < 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(name: &str, b0: f64, bs: f64) -> Point {
        let parameter =
            |value: f64, effect: &str| Parameter::measured(value, (0.1, 5.0), "Nm", effect);
        Point {
            name: name.to_owned(),
            days: None,
            sessions: 3,
            temperature: None,
            held_out: 1.0,
            parameters: BTreeMap::from([
                ("b0".to_owned(), parameter(b0, "coulomb")),
                ("bs".to_owned(), parameter(bs, "stribeck")),
            ]),
            verdict: None,
            missing: None,
        }
    }

    #[test]
    fn what_exceeds_the_errors_changed_and_nothing_else() {
        let points = [
            point("a", 5.0, 0.05),
            point("b", 5.1, 0.10),
            point("c", 6.0, 2.0),
        ];
        let courses = courses(&points);
        assert!(courses[0].changes && courses[0].name == "b0");
        let [first, second] = courses[0].steps.as_slice() else {
            panic!("{courses:?}")
        };
        assert!(!first.exceeds_errors && second.exceeds_errors);
        assert!((second.std_error - 0.02_f64.sqrt()).abs() < 1e-12);
        let whole = courses[0].change.as_ref().unwrap();
        assert_eq!((whole.from.as_str(), whole.to.as_str()), ("a", "c"));
        let turns = turns(&points);
        assert_eq!(turns.len(), 1, "{turns:?}");
        assert!(turns[0].came && turns[0].effect == "stribeck" && turns[0].to == "c");
    }

    #[test]
    fn a_parameter_that_stays_within_its_errors_does_not_change() {
        let points: Vec<Point> = [5.0, 5.1, 4.95, 5.05]
            .iter()
            .map(|b0| point("x", *b0, 1.0))
            .collect();
        assert!(courses(&points).iter().all(|own| !own.changes));
        assert!(turns(&points).is_empty());
    }
}
