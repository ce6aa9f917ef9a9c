//! Positions that begin anew with each turn.

use std::f64::consts::{PI, TAU};

use ferntast_msgs::counted;

use super::{OTHERWISE, steps::Steps};
use crate::recording::series::Series;

/// A step of one turn, give or take so much of it.
const SLACK: f64 = 0.05;
/// Whatever moves as fast as this \[rad\] a sample is no joint whose turns can be told.
const FASTEST: f64 = PI / 4.0;

/// Goes on counting where a position jumps by a turn, and tells where.
pub(super) fn turn_on(position: &mut Series) -> Option<String> {
    let is_turn = |step: f64| (step.abs() - TAU).abs() < SLACK * TAU;
    let mut turns = position.values.windows(2);
    let first = turns.position(|pair| is_turn(pair[1] - pair[0]))?;
    if Steps::of(&position.values).middle > FASTEST {
        return None;
    }
    let mut count = 0;
    let mut added = 0.0;
    let mut last = position.values.first().copied().unwrap_or(0.0);
    for value in &mut position.values {
        let step = *value - last;
        last = *value;
        if is_turn(step) {
            count += 1;
            added -= TAU * step.signum();
        }
        *value += added;
    }
    Some(format!(
        "{}: signals.{} jumps by a turn {}, the first at {:.3} s: it is counted on{OTHERWISE}",
        position.file.display(),
        position.signal,
        counted(count, "time"),
        position.since_start(first + 1),
    ))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::recording::series::Wanted;

    #[test]
    fn a_joint_that_turns_on_and_on_is_counted_on() {
        let wanted = Wanted {
            signal: "position".to_owned(),
            path: String::new(),
            unit: None,
            time: None,
        };
        let angle = |at: i64| 8.0 * (at as f64 * 0.002).sin();
        let mut series = Series::new(&wanted, Path::new("a"));
        series.times = (0..4000).map(|at| at * 5_000_000).collect();
        series.values = (0..4000)
            .map(|at| (angle(at) + PI).rem_euclid(TAU) - PI)
            .collect();
        let note = turn_on(&mut series).unwrap();
        assert!(note.contains("turn 5 times"), "{note}");
        for (at, value) in (0..).zip(&series.values) {
            assert!((value - angle(at)).abs() < 1e-9, "{at}");
        }
        assert_eq!(turn_on(&mut series), None);
    }
}
