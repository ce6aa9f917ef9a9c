//! Whether numbers can be in the units that they are taken to be in.

use std::f64::consts::TAU;

use ferntast_identification::{JointType, numerics::statistics::quantile};

use super::Series;
use crate::{
    experiment::Experiment,
    guess::{angle_unit, time_unit, unit_in_name},
    unit::Unit,
};

/// Notes where the numbers of a file whose unit is not stated can hardly be in the unit that
/// they are taken for.
pub(super) fn check(experiment: &Experiment, series: &[Series], notes: &mut Vec<String>) {
    let Some(position) = series.first() else {
        return;
    };
    let file = position.file.display();
    let signals = &experiment.signals;
    let by_column = experiment.reading.rate_hz.is_none() && !position.times.is_empty();
    if by_column && signals.unit("time").is_none() {
        let first = position
            .times
            .first()
            .map_or(0.0, |time| *time as f64 * 1e-9);
        let step = position.interval();
        if let Some(unit) = time_unit(first, step) {
            notes.push(format!(
                "{file}: a sample every {step} s is implausible, it looks like {unit}: write time = {{ column = \"…\", unit = \"{unit}\" }} under [signals]"
            ));
        }
    }
    if experiment.joint == JointType::Revolute && signals.unit("position").is_none() {
        let mut values = position.values.clone();
        let low = quantile(&mut values, 0.01, f64::total_cmp).unwrap_or(0.0);
        let high = quantile(&mut values, 0.99, f64::total_cmp).unwrap_or(0.0);
        if let Some(unit) = angle_unit(high - low) {
            notes.push(format!(
                "{file}: signals.position moves over {:.0} rad, {:.0} turns: if it is in degrees, write position = {{ column = \"{}\", unit = \"{unit}\" }}",
                high - low,
                (high - low) / TAU,
                signals.position
            ));
        }
    }
    tell_offset(series, notes);
}

/// Notes where a signal is called as if it were in a unit other than that it is taken for.
pub(super) fn check_names(experiment: &Experiment, notes: &mut Vec<String>) {
    let signals = &experiment.signals;
    for (signal, path) in signals.named() {
        let (_, said) = unit_in_name(path);
        let Some(said) = said.filter(|_| signals.unit(signal).is_none()) else {
            continue;
        };
        let taken = experiment.unit_of(signal);
        if said.name() != taken && Unit::parse(&taken).is_some() {
            notes.push(format!(
                "signals.{signal}: {path:?} is called as if it were in {}, and taken for {taken}: write {signal} = {{ column = \"{path}\", unit = \"{}\" }}, or \"{taken}\" if that is right",
                said.name(),
                said.name()
            ));
        }
    }
}

/// Notes where signals of two files last equally long, but one begins later: then
/// the files were started together, and their clocks differ.
fn tell_offset(series: &[Series], notes: &mut Vec<String>) {
    let Some(position) = series.first() else {
        return;
    };
    let ends = |own: &Series| Some((*own.times.first()?, *own.times.last()?));
    let mut told = Vec::new();
    for own in series.iter().filter(|own| own.file != position.file) {
        let (Some((from, to)), Some((first, last))) = (ends(own), ends(position)) else {
            continue;
        };
        let seconds = |a: i64, b: i64| b.saturating_sub(a) as f64 * 1e-9;
        let (starts, stops) = (seconds(first, from), seconds(last, to));
        let length = seconds(first, last);
        let same = (starts - stops).abs() < 0.01 * length;
        if same && starts.abs() > 0.02 * length && !told.contains(&&own.file) {
            told.push(&own.file);
            notes.push(format!(
                "{} begins and ends {:.3} s {} than {}: are both of one clock? If not, shift its time",
                own.file.display(),
                starts.abs(),
                if starts > 0.0 { "later" } else { "earlier" },
                position.file.display()
            ));
        }
    }
}
