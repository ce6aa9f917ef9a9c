//! What a channel does to the torque balance whose time stamps are late, and how it is put right.
//!
//! Channels by number: 0 motor torque, 1 joint torque, 2 position, 3 position where the joint
//! torque is modelled.

use super::{Facts, Point};
use crate::signals::Channels;

/// The channels that can be told to be late from recordings with these `facts`.
pub(super) fn all(facts: &Facts) -> &'static [f64] {
    match facts.no_torque_sensor() {
        None => &[0.0, 1.0, 2.0],
        Some(_) => &[0.0, 3.0],
    }
}

/// What it changes in the torque balance \[Nm\] that `channel` is late by as much as `by` says of
/// each point \[s\]: the odd part alone.
///
/// The even part, from now on, is a mean of neighbours in part, which takes noise off the signal:
/// that of the acceleration is in the residual, and would look like a delay.
pub(super) fn change(
    channel: f64,
    points: &[Point],
    by: impl Fn(&Point) -> f64,
) -> Option<Vec<f64>> {
    let period = points.first()?.period;
    let late = |values: Vec<f64>| -> Vec<f64> {
        let last = values.len().saturating_sub(1);
        let value = |place: f64| {
            let place = place.clamp(0.0, last as f64);
            let before = place as usize;
            let share = place - before as f64;
            let after = values[(before + 1).min(last)];
            values[before] + share * (after - values[before])
        };
        let each = points.iter().enumerate();
        each.map(|(at, point)| {
            let (at, samples) = (at as f64, by(point) / period);
            0.5 * (value(at - samples) - value(at + samples))
        })
        .collect()
    };
    let each = |value: fn(&Point) -> f64| -> Vec<f64> { points.iter().map(value).collect() };
    let early = |values: Vec<f64>| late(values).into_iter().map(|value| -value);
    Some(match channel.round() as i64 {
        0 => late(each(|p| p.motor_predicted)),
        // Friction that grows with the load is late with it.
        1 => early(each(|p| p.load))
            .zip(early(each(|p| p.load.abs())))
            .zip(points)
            .map(|((load, size), p)| load + p.load_slope * size * p.sign())
            .collect(),
        2 => early(each(|p| p.motor_predicted - p.load)).collect(),
        // The load is modelled from the position, and late with it.
        _ => early(each(|p| p.motor_predicted)).collect(),
    })
}

/// Reads `channel` anew: each sample where `place` says that it is \[samples\].
pub(super) fn take_back(channel: f64, channels: &mut Channels, place: impl Fn(f64) -> f64) {
    // A torque that is modelled from the position is late with it.
    let late: &mut [&mut Vec<f64>] = match channel.round() as i64 {
        0 => &mut [&mut channels.motor_torque],
        1 => &mut [&mut channels.joint_torque],
        2 => &mut [&mut channels.position],
        _ => &mut [&mut channels.position, &mut channels.joint_torque],
    };
    for late in late {
        **late = read_at(late, &place);
    }
}

/// `signal` at the places that `place` gives for each, with cubic interpolation; beyond the
/// ends it keeps its first and last value.
fn read_at(signal: &[f64], place: impl Fn(f64) -> f64) -> Vec<f64> {
    if signal.iter().all(|value| *value == 0.0) {
        return signal.to_vec();
    }
    let last = signal.len().saturating_sub(1) as f64;
    let value = |at: f64| signal[at.clamp(0.0, last) as usize];
    let around = |from: f64| {
        let first = (from as usize).checked_sub(1);
        match first.and_then(|first| signal.get(first..first + 4)) {
            Some(&[a, b, c, d]) => [a, b, c, d],
            _ => [-1.0, 0.0, 1.0, 2.0].map(|by| value(from + by)),
        }
    };
    (0..signal.len())
        .map(|at| {
            let place = place(at as f64).clamp(0.0, last);
            // Not negative, so that this is the floor.
            let from = place as usize as f64;
            let [a, b, c, d] = around(from);
            let x = place - from;
            let (slope, curve) = (0.5 * (c - a), a - 2.5 * b + 2.0 * c - 0.5 * d);
            b + x * (slope + x * (curve + x * (0.5 * (d - a) + 1.5 * (b - c))))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_channel_is_taken_back_by_its_delay() {
        let wave = |at: f64| (0.13 * at).sin();
        let signal: Vec<f64> = (0..200).map(|at| wave(f64::from(at))).collect();
        for by in [0.0, 0.3, 1.0, 7.6] {
            let advanced = read_at(&signal, |at| at + by);
            let exact = (2..180).all(|at| (advanced[at] - wave(at as f64 + by)).abs() < 2e-4);
            assert!(exact, "by {by}");
        }
        let stretched = read_at(&signal, |at| 1.05 * at);
        assert!((2..180).all(|at| (stretched[at] - wave(1.05 * at as f64)).abs() < 2e-4));
        assert!(read_at(&[], |at| at).is_empty());
    }
}
