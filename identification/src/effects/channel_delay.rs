//! One channel with time stamps that are late.

use ferntast_model::friction::{Contrast, ONE, Proposal, Unit};

use super::{Effect, Facts, Memory, Point, free, row};
use crate::signals::Channels;

/// Its id.
pub const CHANNEL_DELAY: &str = "channel_delay";

row!(
    ChannelDelay,
    id: CHANNEL_DELAY,
    equation: "x_measured(t) = x(t − d) for one channel: 0 motor torque, 1 joint torque, 2 position (3 where τ is modelled)",
    source: "time stamps",
    coefficients: &[free("delay", Unit::new("s", "s"))],
    shape: &[free("channel", ONE), free("shift", Unit::new("s", "s"))],
    shows_as: "proportional to d(signal)/dt",
    excited_by: "fast accelerations and changes of load",
    shown_by: Proposal::Accelerations,
    contrasts: &[Contrast::Accelerations],
    confusable_with: &["inertia", "viscous", "elasticity"],
    // The shift follows from the delay, and the channel is one of three.
    freedom: Some(1),
    needs_prediction: true,
    acts_on_channels: true,
);

/// Delays that are looked for \[s\].
const LEAST: f64 = 0.0002;
const LARGEST: f64 = 0.2;

/// `signal` advanced by `samples`, with cubic interpolation; beyond the end it
/// keeps its last value.
fn advanced(signal: &[f64], samples: f64) -> Vec<f64> {
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
            let place = (at as f64 + samples).clamp(0.0, last);
            // Not negative, so that this is the floor.
            let from = place as usize as f64;
            let [a, b, c, d] = around(from);
            let x = place - from;
            let (slope, curve) = (0.5 * (c - a), a - 2.5 * b + 2.0 * c - 0.5 * d);
            b + x * (slope + x * (curve + x * (0.5 * (d - a) + 1.5 * (b - c))))
        })
        .collect()
}

impl Effect for ChannelDelay {
    row!(methods);

    // Replaced by `whole`: the true value of a late channel lies ahead.
    fn evaluate(&self, _shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        let _ = point;
        columns.fill(0.0);
    }

    fn whole(&self, shape: &[f64], points: &[Point]) -> Option<Vec<Vec<f64>>> {
        let [channel, delay, ..] = shape else {
            return None;
        };
        let period = points.first()?.period;
        // The odd part of the delay, per second of it: the coefficient is the delay itself. The
        // even part, from now on, is a mean of neighbours in part, which takes noise off the
        // signal: that of the acceleration is in the residual, and would look like a delay.
        let late = |values: Vec<f64>, by: f64| -> Vec<f64> {
            let last = values.len().saturating_sub(1);
            let value = |place: f64| {
                let place = place.clamp(0.0, last as f64);
                let before = place as usize;
                let share = place - before as f64;
                let after = values[(before + 1).min(last)];
                values[before] + share * (after - values[before])
            };
            let samples = by / period;
            (0..values.len())
                .map(|at| at as f64)
                .map(|at| 0.5 * (value(at - samples) - value(at + samples)) / delay)
                .collect()
        };
        let each = |value: fn(&Point) -> f64| -> Vec<f64> { points.iter().map(value).collect() };
        Some(vec![match channel.round() as i64 {
            0 => late(each(|p| p.motor_predicted), *delay),
            // Friction that grows with the load is late with it.
            1 => late(each(|p| p.load), -delay)
                .into_iter()
                .zip(late(each(|p| p.load.abs()), -delay))
                .zip(points)
                .map(|((load, size), p)| load + p.load_slope * size * p.sign())
                .collect(),
            2 => late(each(|p| p.motor_predicted - p.load), -delay),
            // The load is modelled from the position, and late with it.
            _ => late(each(|p| p.motor_predicted), -delay),
        }])
    }

    fn shapes(&self, facts: &Facts) -> Vec<Vec<f64>> {
        let channels: &[f64] = if facts.no_torque_sensor().is_none() {
            &[0.0, 1.0, 2.0]
        } else {
            &[0.0, 3.0]
        };
        channels
            .iter()
            .flat_map(|channel| {
                [0.0005, 0.0015, 0.004, 0.01, 0.02, 0.035, 0.06, 0.09, 0.13]
                    .map(|d| vec![*channel, d])
            })
            .collect()
    }

    fn bounds(&self, _facts: &Facts) -> Vec<[f64; 2]> {
        // The channel is not refined.
        vec![[0.0, 0.0], [LEAST, LARGEST]]
    }

    fn compensate(
        &self,
        shape: &[f64],
        coefficients: &[f64],
        channels: &mut Channels,
        period: f64,
    ) -> usize {
        let ([channel, ..], [delay, ..]) = (shape, coefficients) else {
            return 0;
        };
        // A torque that is modelled from the position is late with it.
        let late: &mut [&mut Vec<f64>] = match channel.round() as i64 {
            0 => &mut [&mut channels.motor_torque],
            1 => &mut [&mut channels.joint_torque],
            2 => &mut [&mut channels.position],
            _ => &mut [&mut channels.position, &mut channels.joint_torque],
        };
        let samples = delay / period;
        for late in late {
            **late = advanced(late, samples);
        }
        samples.abs().ceil() as usize + 1
    }

    // A stamp is late, not early. How far apart the difference is taken (the shift) tells little of
    // the delay: in motion of a single frequency its odd part is the same for all.
    fn plausible(&self, _shape: &[f64], coefficients: &[f64]) -> bool {
        coefficients.iter().all(|c| (LEAST..LARGEST).contains(c))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_channel_is_taken_back_by_its_delay() {
        let wave = |at: f64| (0.13 * at).sin();
        let signal: Vec<f64> = (0..200).map(|at| wave(f64::from(at))).collect();
        for by in [0.0, 0.3, 1.0, 7.6] {
            let advanced = advanced(&signal, by);
            let exact = (2..180).all(|at| (advanced[at] - wave(at as f64 + by)).abs() < 2e-4);
            assert!(exact, "by {by}");
        }
        assert!(advanced(&[], 1.0).is_empty());
    }
}
