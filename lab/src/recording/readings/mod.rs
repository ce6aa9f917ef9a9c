//! What recordings of real machines have in them that nothing moved like: a reading that was
//! wrong, one that was sent again, a counter that began anew, times of arrival in place of
//! times of measurement.
//!
//! Each is found by what the signal does otherwise, by no limit in its unit, and told. With
//! `readings = "as_recorded"` nothing is changed.

mod clock;
mod held;
mod spikes;
mod stale;
mod steps;
mod turns;

use std::ops::Range;

use ferntast_identification::JointType;
use ferntast_msgs::counted;

use super::{Series, VALID, tally::Tally};
use crate::experiment::{Experiment, POSITION};

/// What is told of how to have it otherwise.
const OTHERWISE: &str = " (readings = \"as_recorded\" keeps them)";

/// Gives samples of `series`, the position first, the times of the clock that they were taken
/// by, where the position tells it; a note says so.
pub(super) fn set_clock(series: &mut [Series]) -> Option<String> {
    clock::set_right(series)
}

/// What a signal is of, as far as it matters here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// What moves, and is at no two places at once.
    Position,
    /// Torque or force.
    Force,
    /// What changes slowly: a temperature.
    Slow,
}

/// The kind of a signal; `None` of what may jump as it likes.
fn kind_of(signal: &str, experiment: &Experiment) -> Option<Kind> {
    let is_of_joint = experiment.arm.is_some();
    match signal {
        VALID => None,
        "position" | super::TIP_X | super::TIP_Y => Some(Kind::Position),
        own if is_of_joint && own.starts_with(POSITION) => Some(Kind::Position),
        "temperature" => Some(Kind::Slow),
        own if own.starts_with("extra.") && !is_of_joint => None,
        _ => Some(Kind::Force),
    }
}

/// Takes out of `series`, the position first, what was not measured, or not then; `notes` tell
/// what, and `tally` how much of the position.
pub(super) fn clean(
    experiment: &Experiment,
    series: &mut [Series],
    tally: &mut Tally,
    notes: &mut Vec<String>,
) {
    if experiment.reading.as_recorded {
        return;
    }
    let kinds: Vec<Option<Kind>> = series
        .iter()
        .map(|own| kind_of(&own.signal, experiment))
        .collect();
    if experiment.joint == JointType::Revolute {
        let positions = series.iter_mut().zip(&kinds);
        for (own, _) in positions.filter(|(_, kind)| **kind == Some(Kind::Position)) {
            notes.extend(turns::turn_on(own));
        }
    }
    for (at, kind) in kinds.iter().enumerate() {
        let Some(kind) = kind else { continue };
        let Some(own) = series.get(at) else { continue };
        let held = match kind {
            Kind::Slow => None,
            Kind::Position | Kind::Force => held::repeats(&own.values),
        };
        let held_samples = held.as_ref().map_or(0, |held| count(&held.repeats));
        if let Some(held) = held {
            notes.push(format!(
                "{}: signals.{} has a new value with every {} sample only: the others left out{OTHERWISE}",
                own.file.display(),
                own.signal,
                ordinal(held.every),
            ));
            series[at].remove(&held.repeats);
        }
        let position = (at > 0).then(|| &series[0]);
        let own = &series[at];
        let stale = match kind {
            Kind::Position => stale::of_position(&own.values, &own.stretches()),
            Kind::Force => stale::of_force(own, position),
            Kind::Slow => Vec::new(),
        };
        let stale_samples = count(&stale);
        if let Some(first) = stale.first() {
            notes.push(format!(
                "{}: signals.{} stands still while the joint moves, {}, the first at {:.3} s: {stale_samples} samples left out{OTHERWISE}",
                own.file.display(),
                own.signal,
                counted(stale.len(), "time"),
                own.since_start(first.start),
            ));
            series[at].remove(&stale);
        }
        let own = &series[at];
        let found = spikes::find(&own.values, &own.stretches(), *kind);
        let spike_samples = count(&found.runs);
        if let Some(first) = found.runs.first() {
            notes.push(format!(
                "{}: signals.{} jumps away and back {}, by more than {:.4}, the first at {:.3} s: {spike_samples} samples left out as wrong readings{OTHERWISE}",
                own.file.display(),
                own.signal,
                counted(found.runs.len(), "time"),
                found.threshold,
                own.since_start(first.start),
            ));
            series[at].remove(&found.runs);
        }
        if at == 0 {
            tally.repeats = held_samples;
            tally.wrong_readings = stale_samples + spike_samples;
        }
    }
}

fn count(runs: &[Range<usize>]) -> usize {
    runs.iter().map(ExactSizeIterator::len).sum()
}

fn ordinal(number: usize) -> String {
    match number {
        2 => "2nd".to_owned(),
        3 => "3rd".to_owned(),
        number => format!("{number}th"),
    }
}

/// Runs of samples that have the value of the one before, with that one.
fn runs_of_equal(values: &[f64]) -> impl Iterator<Item = Range<usize>> + '_ {
    let mut start = 0;
    let is_end = move |end: &usize| values.get(*end) != values.get(*end - 1);
    let ends = (1..=values.len()).filter(is_end);
    ends.map(move |end| std::mem::replace(&mut start, end)..end)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_cover_everything_once() {
        let runs = |values: &[f64]| runs_of_equal(values).collect::<Vec<_>>();
        assert_eq!(runs(&[1.0, 1.0, 2.0, 3.0, 3.0, 3.0]), [0..2, 2..3, 3..6]);
        assert_eq!(runs(&[1.0, 2.0]), [0..1, 1..2]);
        assert!(runs(&[]).is_empty());
    }
}
