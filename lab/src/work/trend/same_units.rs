//! Whether what is held beside each other has the same units.

use std::collections::BTreeMap;

use ferntast_identification::JointType;

use super::{
    Point, TrendError,
    parts::{Part, Parted, path_of},
};
use crate::experiment::Experiment;

/// What a file's numbers are in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnitIn {
    /// The file.
    pub file: String,
    /// The unit; of what was recorded, its kind.
    pub unit: String,
}

/// The kind of joint, torques or forces, and extra signals whose unit both files state.
///
/// # Errors
///
/// [`TrendError::Units`]: the first file, and one that differs from it.
pub(super) fn of_experiments<T: Parted>(all: &[&T]) -> Result<(), TrendError> {
    let mut experiments = all.iter().map(|own| own.experiment());
    let Some(first) = experiments.next() else {
        return Ok(());
    };
    for other in experiments {
        let both = |what: &str, unit: &dyn Fn(&Experiment) -> String| {
            let [first, other] = [first, other].map(|own| UnitIn::of(own, unit(own)));
            same(what, &first, &other)
        };
        both("what was recorded", &|own| kind(own.joint).to_owned())?;
        both("torque or force", &|own| own.force_unit().to_owned())?;
        for signal in first.signals.extra.keys() {
            let key = format!("extra.{signal}");
            if [first, other].map(|own| own.signals.unit(&key).is_some()) == [true; 2] {
                both(&format!("signal {signal}"), &|own| own.unit_of(&key))?;
            }
        }
    }
    Ok(())
}

/// Parameters of the same name; a part may have been fitted by a model of its own.
///
/// # Errors
///
/// [`TrendError::Units`].
pub(super) fn of_parameters<T: Parted>(
    parts: &[Part<'_, T>],
    points: &[Point],
) -> Result<(), TrendError> {
    let mut known: BTreeMap<&str, UnitIn> = BTreeMap::new();
    for (part, point) in parts.iter().zip(points) {
        for (name, parameter) in &point.parameters {
            let own = UnitIn::of(part.opened.experiment(), parameter.unit.clone());
            let first = known.entry(name).or_insert_with(|| own.clone());
            same(&format!("parameter {name}"), first, &own)?;
        }
    }
    Ok(())
}

impl UnitIn {
    fn of(experiment: &Experiment, unit: String) -> UnitIn {
        let file = path_of(experiment).display().to_string();
        UnitIn { file, unit }
    }
}

fn same(what: &str, first: &UnitIn, other: &UnitIn) -> Result<(), TrendError> {
    match first.unit == other.unit {
        true => Ok(()),
        false => Err(TrendError::Units {
            what: what.to_owned(),
            first: first.clone(),
            other: other.clone(),
        }),
    }
}

fn kind(joint: JointType) -> &'static str {
    match joint {
        JointType::Revolute => "a revolute joint",
        JointType::Prismatic => "a prismatic joint",
        JointType::Contact => "a contact",
    }
}
