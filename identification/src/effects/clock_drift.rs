//! One channel recorded by a clock that runs faster or slower than that of the others.

use ferntast_model::friction::{Contrast, ONE, Proposal, Unit};

use super::{Effect, Facts, Memory, Point, free, late_channel, row};
use crate::signals::{Channels, InvalidSamples};

row!(
    ClockDrift,
    id: "clock_drift",
    equation: "x_measured(t) = x(t − d t), t from the recording's start, for one channel: 0 motor torque, 1 joint torque, 2 position",
    source: "clocks of two recorders",
    coefficients: &[free("drift", Unit::new("s/s", "s/s"))],
    shape: &[free("channel", ONE), free("tried", Unit::new("s/s", "s/s"))],
    shows_as: "proportional to d(signal)/dt, the larger the later in a recording",
    excited_by: "long recordings, fast accelerations and changes of load",
    shown_by: Proposal::Accelerations,
    contrasts: &[Contrast::Accelerations],
    confusable_with: &["channel_delay", "inertia", "viscous"],
    // The drift tried says little beside the drift, and the channel is one of three.
    freedom: Some(1),
    needs_prediction: true,
    acts_on_channels: true,
    is_lateness: true,
);

/// Drifts that are believed \[s/s\]: from less than that of a bad quartz to more than that of
/// times that a busy computer gives.
const LEAST: f64 = 5e-6;
const LARGEST: f64 = 0.02;

/// Of two channels alone, one is ahead where the other is late.
fn channels(facts: &Facts) -> impl Iterator<Item = f64> {
    let all = late_channel::all(facts).iter().copied();
    all.filter(|channel| *channel < 3.0)
}

impl Effect for ClockDrift {
    row!(methods);

    // Replaced by `whole`: the true value of a channel that is late lies ahead.
    fn evaluate(&self, _shape: &[f64], point: &Point, _memory: &mut Memory, columns: &mut [f64]) {
        let _ = point;
        columns.fill(0.0);
    }

    fn whole(&self, shape: &[f64], points: &[Point]) -> Option<Vec<Vec<f64>>> {
        let [channel, tried, ..] = shape else {
            return None;
        };
        let mut column = late_channel::change(*channel, points, |point| tried * point.time)?;
        column.iter_mut().for_each(|value| *value /= tried);
        Some(vec![column])
    }

    fn shapes(&self, facts: &Facts) -> Vec<Vec<f64>> {
        channels(facts)
            .flat_map(|channel| [1e-4, 4e-4, 1.2e-3, 3e-3].map(|tried| vec![channel, tried]))
            .collect()
    }

    // A position that is late is nearly a motor torque that is ahead.
    fn alternatives(&self, shape: &[f64], facts: &Facts) -> Vec<Vec<f64>> {
        let [channel, tried, ..] = shape else {
            return Vec::new();
        };
        let others = channels(facts).filter(|other| other != channel);
        others.map(|other| vec![other, *tried]).collect()
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
        let ([channel, ..], [drift, ..]) = (shape, coefficients) else {
            return InvalidSamples::default();
        };
        let (Some(first), Some(last)) = (points.first(), points.last()) else {
            return InvalidSamples::default();
        };
        let since = first.time / first.period;
        late_channel::take_back(*channel, channels, |at| at + drift * (since + at));
        InvalidSamples::read_late_by([first, last].map(|own| drift * own.time / own.period))
    }

    fn plausible(&self, _shape: &[f64], coefficients: &[f64]) -> bool {
        let range = LEAST..LARGEST;
        coefficients.iter().all(|c| range.contains(&c.abs()))
    }
}
