//! The measured damping torque τ_F = τ_m − J q̈ − τ (equation 2) by speed: the
//! paper's Figs. 10 to 14.

use serde::Serialize;

use crate::data::Dataset;
use crate::numerics::filter::Kernel;
use crate::numerics::statistics::mean_error;
use crate::signals::{Filters, Signals};

/// Mean damping torque in a range of speeds |q̇|.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Average {
    /// Least and largest speed \[rad/s\].
    pub range: [f64; 2],
    /// Mean of τ_F sign(q̇) \[Nm\].
    pub mean: f64,
    /// Its standard error over stretches of time \[Nm\].
    pub std_error: f64,
    /// Number of samples.
    pub count: usize,
}

/// Damping torque at one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// q̇ \[rad/s\].
    pub velocity: f64,
    /// τ \[Nm\].
    pub load: f64,
    /// τ_F \[Nm\].
    pub damping: f64,
}

/// Stretches of time that a mean's error comes from.
const STRETCHES: usize = 10;

/// The damping torque of all samples away from rest and reversals, with motor
/// inertia `inertia` \[kg m²\] (J of equation 2).
#[must_use]
pub fn samples(dataset: &Dataset, inertia: f64) -> Vec<Sample> {
    let filters = Filters::choose(&dataset.sessions);
    dataset
        .sessions
        .iter()
        .flat_map(|session| {
            let signals = Signals::new(session, &filters);
            let smooth = Kernel::gaussian(filters.column, 0, signals.period);
            let of = |channel: fn(&crate::signals::Point) -> f64| -> Vec<f64> {
                let values: Vec<f64> = signals.points.iter().map(channel).collect();
                smooth.at_samples(&values, &signals.rows)
            };
            let velocity = of(|point| point.velocity);
            let acceleration = of(|point| point.acceleration);
            let load = of(|point| point.load);
            let motor = of(|point| point.motor_torque);
            (0..signals.rows.len())
                .map(|at| Sample {
                    velocity: velocity[at],
                    load: load[at],
                    damping: motor[at] - inertia * acceleration[at] - load[at],
                })
                .collect::<Vec<_>>()
        })
        .collect()
}

/// Mean damping in each of `ranges` of speed \[rad/s\]; `None` where there are
/// fewer than 20 samples.
#[must_use]
pub fn averages(samples: &[Sample], ranges: &[[f64; 2]]) -> Vec<Option<Average>> {
    ranges
        .iter()
        .map(|&range| {
            let values: Vec<f64> = samples
                .iter()
                .filter(|sample| (range[0]..=range[1]).contains(&sample.velocity.abs()))
                .map(|sample| sample.damping * sample.velocity.signum())
                .collect();
            if values.len() < 20 {
                return None;
            }
            let means: Vec<f64> = (0..STRETCHES)
                .map(|part| {
                    let (from, to) = (
                        part * values.len() / STRETCHES,
                        (part + 1) * values.len() / STRETCHES,
                    );
                    values[from..to].iter().sum::<f64>() / (to - from) as f64
                })
                .collect();
            Some(Average {
                range,
                mean: values.iter().sum::<f64>() / values.len() as f64,
                std_error: mean_error(&means).1,
                count: values.len(),
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn averages_are_those_of_their_range() {
        let samples: Vec<Sample> = (0..400)
            .map(|k| {
                let velocity = if k % 2 == 0 { 0.1 } else { -0.5 };
                Sample {
                    velocity,
                    load: 0.0,
                    damping: velocity.signum() * (10.0 + 20.0 * f64::abs(velocity)),
                }
            })
            .collect();
        let found = averages(&samples, &[[0.05, 0.2], [0.4, 0.6], [0.8, 0.9]]);
        assert!((found[0].unwrap().mean - 12.0).abs() < 1e-9);
        assert!((found[1].unwrap().mean - 20.0).abs() < 1e-9);
        assert_eq!((found[1].unwrap().count, found[2]), (200, None));
    }
}
