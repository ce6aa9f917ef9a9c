//! Results in the units that the recordings have.

use std::collections::BTreeMap;

use ferntast_identification::{
    comparison::residual_map::ResidualMap,
    fit::{Parameter, Soundness},
};

use crate::{experiment::Experiment, unit::in_drive_units};

/// Units of parameters where something else stands for the torque.
pub(super) fn in_units_of(experiment: &Experiment, parameters: &mut BTreeMap<String, Parameter>) {
    if let Some(drive) = experiment.drive_unit() {
        for own in parameters.values_mut() {
            own.unit = in_drive_units(&own.unit, drive);
        }
    }
}

/// The same of parameters that are not possible.
pub(super) fn implausible(experiment: &Experiment, soundness: &mut Soundness) {
    if let Some(drive) = experiment.drive_unit() {
        for own in &mut soundness.implausible {
            own.unit = in_drive_units(&own.unit, drive);
        }
    }
}

/// Units of extra signals as stated, in place of their names in brackets.
pub(super) fn of_extra_signals(
    experiment: &Experiment,
    parameters: &mut BTreeMap<String, Parameter>,
) {
    for signal in experiment.signals.extra.keys() {
        if let Some(unit) = experiment.signals.unit(&format!("extra.{signal}")) {
            for own in parameters.values_mut() {
                own.unit = own.unit.replace(&format!("[{signal}]"), unit.name());
            }
        }
    }
}

/// The same of the signals of maps; of extra signals as stated.
pub(super) fn maps(experiment: &Experiment, maps: &mut [ResidualMap]) {
    for map in maps {
        if let Some(drive) = experiment.drive_unit() {
            map.unit = in_drive_units(&map.unit, drive);
        }
        if let Some(unit) = experiment.signals.unit(&format!("extra.{}", map.signal)) {
            unit.name().clone_into(&mut map.unit);
        }
    }
}
