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

use super::{
    series::{Series, TIP_X, TIP_Y, VALID, split},
    tally::Tally,
};
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
        "position" | TIP_X | TIP_Y => Some(Kind::Position),
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
    for at in 0..series.len() {
        let Some(kind) = kind_of(&series[at].signal, experiment) else {
            continue;
        };
        if kind == Kind::Position && experiment.joint == JointType::Revolute {
            notes.extend(turns::turn_on(&mut series[at]));
        }
        let held = held(&series[at], kind);
        let repeats = leave_out(&mut series[at], held, notes);
        let stale = stale(&series[at], kind, series.first().filter(|_| at > 0));
        let stale = leave_out(&mut series[at], stale, notes);
        let spikes = spikes(&series[at], kind);
        let spikes = leave_out(&mut series[at], spikes, notes);
        if at == 0 {
            tally.repeats = repeats;
            tally.wrong_readings = stale + spikes;
        }
    }
}

/// Samples to be left out, and what they are in words.
struct Found {
    runs: Vec<Range<usize>>,
    what: String,
}

/// Leaves them out of `own`, tells it, and returns how many they are.
fn leave_out(own: &mut Series, found: Option<Found>, notes: &mut Vec<String>) -> usize {
    let Some(Found { runs, what }) = found else {
        return 0;
    };
    let count = runs.iter().map(ExactSizeIterator::len).sum();
    notes.push(format!(
        "{}: signals.{} {what}: {} left out{OTHERWISE}",
        own.file.display(),
        own.signal,
        counted(count, "sample"),
    ));
    own.remove(&runs);
    count
}

fn held(own: &Series, kind: Kind) -> Option<Found> {
    let held = (kind != Kind::Slow).then(|| held::repeats(&own.values));
    let held::Held { every, repeats } = held.flatten()?;
    Some(Found {
        runs: repeats,
        what: format!("has a new value with every {} sample only", ordinal(every)),
    })
}

fn stale(own: &Series, kind: Kind, position: Option<&Series>) -> Option<Found> {
    let runs = match kind {
        Kind::Position => stale::of_position(&own.values, &own.stretches()),
        Kind::Force => stale::of_force(own, position),
        Kind::Slow => Vec::new(),
    };
    let first = own.since_start(runs.first()?.start);
    let times = counted(runs.len(), "time");
    Some(Found {
        runs,
        what: format!("stands still while the joint moves, {times}, the first at {first:.3} s"),
    })
}

fn spikes(own: &Series, kind: Kind) -> Option<Found> {
    let spikes::Spikes {
        runs, threshold, ..
    } = spikes::find(&own.values, &own.stretches(), kind);
    let first = own.since_start(runs.first()?.start);
    let times = counted(runs.len(), "time");
    Some(Found {
        runs,
        what: format!(
            "jumps away and back {times}, by more than {threshold:.4}, the first at {first:.3} s"
        ),
    })
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
    split(values.len(), |at| values[*at] != values[at - 1])
}

/// What `find` finds within each of the `stretches` of `values`, by the places in all of them.
fn in_each(
    values: &[f64],
    stretches: &[Range<usize>],
    mut find: impl FnMut(&[f64]) -> Vec<Range<usize>>,
) -> Vec<Range<usize>> {
    let each = stretches.iter().flat_map(|stretch| {
        let own = find(values.get(stretch.clone()).unwrap_or_default()).into_iter();
        own.map(|run| run.start + stretch.start..run.end + stretch.start)
    });
    each.collect()
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
