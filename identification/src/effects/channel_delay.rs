//! One channel with time stamps that are late.

use ferntast_model::friction::{Contrast, ONE, Proposal, Unit};

use super::{Effect, Facts, Memory, Point, free, late_channel, row};
use crate::signals::{Channels, InvalidSamples};

row!(
    ChannelDelay,
    id: "channel_delay",
    equation: "x_measured(t) = x(t − d) for one channel: 0 motor torque, 1 joint torque, 2 position (3 where τ is modelled)",
    source: "time stamps",
    coefficients: &[free("delay", Unit::new("s", "s"))],
    shape: &[free("channel", ONE), free("shift", Unit::new("s", "s"))],
    shows_as: "proportional to d(signal)/dt",
    excited_by: "fast accelerations and changes of load",
    shown_by: Proposal::Accelerations,
    contrasts: &[Contrast::Accelerations],
    confusable_with: &["inertia", "viscous", "elasticity", "clock_drift"],
    // The shift follows from the delay, and the channel is one of three.
    freedom: Some(1),
    needs_prediction: true,
    acts_on_channels: true,
    is_lateness: true,
);

/// Delays that are looked for \[s\].
const LEAST: f64 = 0.0002;
const LARGEST: f64 = 0.2;

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
        // Per second of the delay: the coefficient is the delay itself.
        let mut column = late_channel::change(*channel, points, |_| *delay)?;
        column.iter_mut().for_each(|value| *value /= delay);
        Some(vec![column])
    }

    fn shapes(&self, facts: &Facts) -> Vec<Vec<f64>> {
        late_channel::all(facts)
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
        points: &[Point],
    ) -> InvalidSamples {
        let first = points.first();
        let ([channel, ..], [delay, ..], Some(first)) = (shape, coefficients, first) else {
            return InvalidSamples::default();
        };
        let samples = delay / first.period;
        late_channel::take_back(*channel, channels, |at| at + samples);
        InvalidSamples::read_late_by([samples; 2])
    }

    // A stamp is late, not early. How far apart the difference is taken (the shift) tells little of
    // the delay: in motion of a single frequency its odd part is the same for all.
    fn plausible(&self, _shape: &[f64], coefficients: &[f64]) -> bool {
        coefficients.iter().all(|c| (LEAST..LARGEST).contains(c))
    }
}
