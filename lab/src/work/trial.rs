//! A mapping tried out before anything is written: what would be read.

use std::path::Path;

use serde::Serialize;

use super::{
    Again, Doubt, WorkError,
    doubt::{Taken, doubts},
    read::WhatIsRead,
    start::text,
};
use crate::{
    experiment::{Change, Experiment, Mapping, data_folder},
    recording::{Seen, Tally, preview},
    unit::Unit,
};

/// What would be read and written.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Trial {
    /// Keys of signals that are to be chosen yet; `contour` where a tip's is.
    pub missing: Vec<String>,
    /// Each signal of each recording, as far as it can be read.
    pub signals: Vec<Seen>,
    /// Mean rate \[Hz\] of what is used.
    pub rate_hz: Option<f64>,
    /// Share of all samples that is used.
    pub share_used: Option<f64>,
    /// What of each recording is used.
    pub recordings: Vec<Tally>,
    /// What was noticed in reading.
    pub warnings: Vec<String>,
    /// Units that are implausible.
    pub doubts: Vec<Doubt>,
    /// Why it cannot be used as it is.
    pub troubles: Vec<String>,
    /// What would be replaced in a file that is mapped again.
    pub changes: Vec<Change>,
}

/// Reads the recordings as the experiment file at `output` would have them read.
///
/// # Errors
///
/// The file that is mapped again is another by now. All else is told in the trial.
pub fn trial(mapping: &Mapping, again: Option<&Again>, output: &Path) -> Result<Trial, WorkError> {
    let mut trial = Trial::default();
    let parse = |mapping: &Mapping| -> Parsed {
        let changed = text(mapping, again, output)?;
        let experiment = Experiment::parse(&changed.text, output, &data_folder())?;
        Ok((experiment, changed.changes))
    };
    let mut whole = mapping.clone();
    whole.signals.retain(|_, place| !place.column.is_empty());
    let parsed = parse(&whole);
    let shown = match &parsed {
        Ok((experiment, changes)) => {
            trial.changes.clone_from(changes);
            Some(experiment.clone())
        }
        Err(WorkError::Changed { .. }) => return parsed.map(|_| trial),
        Err(_) => partly(&whole, &parse),
    };
    if parsed.is_err() {
        let needed = whole.needed().into_iter();
        trial.missing = needed
            .filter(|key| !whole.signals.contains_key(key))
            .collect();
        if whole.signals.contains_key("tip[0]") && whole.contour.is_none() {
            trial.missing.push("contour".to_owned());
        }
    }
    if let Some(experiment) = &shown {
        let (seen, errors) = preview(experiment);
        trial.doubts = doubted(&whole, experiment, &seen);
        trial.signals = seen;
        trial.troubles = errors.iter().map(ToString::to_string).collect();
    }
    let opened = match parsed {
        Ok((experiment, _)) => WhatIsRead::of(&stated(experiment)),
        Err(error) => Err(error),
    };
    match opened {
        Ok(read) => {
            trial.rate_hz = Some(read.rate_hz);
            trial.share_used = Some(read.share_used);
            trial.recordings = read.recordings;
            trial.warnings = read.notes;
        }
        // What is still to be chosen is told as that.
        Err(_) if !trial.missing.is_empty() => {}
        Err(error) => {
            let text = error.to_string();
            if !trial.troubles.contains(&text) {
                trial.troubles.push(text);
            }
        }
    }
    Ok(trial)
}

/// An experiment, and what is replaced for it.
type Parsed = Result<(Experiment, Vec<Change>), WorkError>;

/// As much of an experiment as can be looked at: signals that are not chosen yet have
/// no path; if that does not do, units are left out.
fn partly(mapping: &Mapping, parse: &dyn Fn(&Mapping) -> Parsed) -> Option<Experiment> {
    let mut mapping = mapping.clone();
    for key in mapping.needed() {
        mapping.signals.entry(key).or_default();
    }
    // Coordinates are looked at before they are laid on anything.
    if mapping.signals.contains_key("tip[0]") && mapping.contour.is_none() {
        mapping.contour = Some(vec![[0.0, 0.0], [1.0, 0.0]]);
    }
    let found = parse(&mapping).or_else(|_| {
        for place in mapping.signals.values_mut() {
            place.unit = None;
        }
        parse(&mapping)
    });
    found.ok().map(|(experiment, _)| experiment)
}

/// The experiment with every unit stated: what is odd about them is in the doubts.
fn stated(mut experiment: Experiment) -> Experiment {
    let keys = [
        "time",
        "position",
        "tip[0]",
        "tip[1]",
        "motor_torque",
        "joint_torque",
        "normal_force",
        "temperature",
    ];
    for key in keys {
        if experiment.signals.unit(key).is_none()
            && let Some(unit) = Unit::parse(&experiment.unit_of(key))
        {
            experiment.signals.units.insert(key.to_owned(), unit);
        }
    }
    experiment
}

fn doubted(mapping: &Mapping, experiment: &Experiment, seen: &[Seen]) -> Vec<Doubt> {
    let of_position = |own: &&Seen| own.signal.starts_with("position");
    let position = seen.iter().find(of_position);
    let taken = mapping.signals.iter().filter_map(|(key, place)| {
        let unit = place.unit.clone();
        let of_time = key == "time";
        let own = match of_time {
            true => position.or(seen.first()),
            false => seen.iter().find(|own| own.signal == *key),
        }?;
        Some((
            key,
            place,
            unit.unwrap_or_else(|| experiment.unit_of(key)),
            own,
        ))
    });
    let taken: Vec<_> = taken.collect();
    doubts(taken.iter().map(|(key, place, unit, own)| Taken {
        key,
        column: &place.column,
        unit,
        first: own.first,
        step: own.interval,
        range: own.range.map_or(0.0, |[least, greatest]| greatest - least),
    }))
}
