//! A load that a model gives: its gain and its zero are uncertain, and known to be so before
//! anything is measured. A pull over position that nobody knows of has to show beyond them.
//!
//! Where load goes with position, as behind a spring or below a weight, a gain and a zero that
//! are wrong at once are nearly a line over position: what a cable has. The data then say
//! little of which it is; what is known of the load decides, and the other is told to be
//! indistinguishable.

use super::candidates::Candidate;
use super::encompassing_test::{
    BySession, MIN_P_VALUE_REDUNDANT, SingleColumn, p_value_of_columns,
};
use super::equivalents::as_good;
use crate::design::{Design, PreparedModel};
use crate::effects::{ConstantOf, EffectHandle, find_by_row};

/// What may be wrong with the load as a model gives it, the simplest first.
const ERRORS: [&str; 3] = [
    "torque_sensor_offset",
    "torque_sensor_gain",
    "torque_sensor_calibration",
];

/// Whether the load is that of a model whose gain and zero may be wrong.
fn is_uncertain(prepared: &PreparedModel) -> bool {
    prepared.facts.torque_is_modelled && prepared.facts.no_torque_channel().is_none()
}

/// Leaves out of `passing` the pulls over position that add nothing to gain and zero of a
/// modelled load, of those `tried`, and to a constant of the friction's.
pub fn drop_pulls(
    prepared: &PreparedModel,
    design: &Design,
    passing: &mut Vec<Candidate>,
    tried: &[Candidate],
) {
    if !is_uncertain(prepared) {
        return;
    }
    let [.., whole] = ERRORS;
    let Some(errors) = tried.iter().find(|own| own.id() == whole) else {
        return;
    };
    passing.retain(|pull| {
        if !pull.effect.row().is_load {
            return true;
        }
        // A line is its slope here: the constant is there already.
        let constants = [ConstantOf::Sensor, ConstantOf::Friction];
        let constants = constants.map(|of| find_by_row(|row| row.constant == Some(of)));
        let mut parts = constants.iter().flatten();
        let beyond = parts.find_map(|own| pull.effect.row().column_beyond(own.row().id));
        let effect: EffectHandle = match beyond {
            Some(column) => std::sync::Arc::new(SingleColumn {
                whole: pull.effect.clone(),
                column,
            }),
            None => pull.effect.clone(),
        };
        let more = design.extra_columns(prepared, &effect, &pull.shape);
        p_value_of_columns(design, all_errors(prepared, design, errors), more)
            < MIN_P_VALUE_REDUNDANT
    });
}

/// Columns of the load's errors, and a constant where that is another column.
fn all_errors(prepared: &PreparedModel, design: &Design, errors: &Candidate) -> BySession {
    let mut columns = design.extra_columns(prepared, &errors.effect, &errors.shape);
    if prepared.facts.load_coulomb {
        for own in &mut columns {
            let rows = own.first().map_or(0, Vec::len);
            own.push(vec![1.0; rows]);
        }
    }
    columns
}

/// Where the first is a pull over position that errors of a modelled load explain as well, puts
/// the simplest of these first.
pub fn put_first(prepared: &PreparedModel, design: &Design, passing: &mut Vec<Candidate>) {
    let Some(first) = passing.first().cloned() else {
        return;
    };
    if !is_uncertain(prepared) || !first.effect.row().is_load {
        return;
    }
    let equal = |own: &Candidate| as_good(design, &first, own);
    let places = ERRORS.iter().filter_map(|id| {
        let at = passing.iter().position(|own| own.id() == *id)?;
        equal(&passing[at]).then_some(at)
    });
    if let Some(at) = places.into_iter().next() {
        let errors = passing.remove(at);
        passing.insert(0, errors);
    }
}
