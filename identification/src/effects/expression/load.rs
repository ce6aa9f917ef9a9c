//! Whether a formula is a load on the joint.

use super::{Formula, OF_JOINT, Row};
use crate::data::{CustomEffect, Subject};

/// The row of a formula that is a load.
pub(super) static ROW: Row = Row {
    is_load: true,
    ..Row::NONE
};

/// Signals of which a load is a function: weight, spring, inertia.
const OF_LOADS: [&str; 2] = ["q", "qdd"];

/// Whether friction by load goes with the formula where no sensor measures the load:
/// if it reads position, acceleration and the signals `extras` (the motion of other
/// joints, a torque computed outside), and nothing else.
#[must_use]
pub fn is_load(custom: &CustomEffect, subject: Subject, extras: &[String]) -> bool {
    let Ok(formula) = Formula::parse(&custom.expression) else {
        return false;
    };
    let names = formula.names();
    let is_fitting = |name: &String| OF_LOADS.contains(&name.as_str()) || extras.contains(name);
    let is_other = |name: &String| OF_JOINT.contains(&name.as_str()) && !is_fitting(name);
    subject == Subject::Joint && names.iter().any(is_fitting) && !names.iter().any(is_other)
}
