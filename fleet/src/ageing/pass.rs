//! Going through the days of all series, one model beside the other.

use super::filter::{BOUND, Filter};
use super::location::location;
use super::series::{Observation, Series};
use super::spread::Spread;
use super::states::Common;

/// Robots that have to tell on a day, not named: of two nobody can say which is different.
const LEAST_SIBLINGS: usize = 3;
/// How long a robot that was named says nothing of its siblings \[d\].
pub(super) const NAMED: i64 = 30;

/// What a robot's values cost.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cost {
    /// Negative log-likelihood with bounded innovations.
    pub cost: f64,
    /// Sum of squared bounded innovations.
    pub bounded: f64,
    /// How many values.
    pub values: f64,
}

impl Cost {
    /// Counts a standardized innovation `u` of that variance.
    pub fn count(&mut self, u: f64, variance: f64) {
        const BEND: f64 = 2.0;
        let u = u.abs();
        let huber = if u > BEND {
            BEND * (u - 0.5 * BEND)
        } else {
            0.5 * u * u
        };
        self.cost += huber + 0.5 * variance.ln();
        self.bounded += u.min(BOUND).powi(2);
        self.values += 1.0;
    }
}

/// What a pass over all days gives.
pub(super) struct Pass {
    pub filters: Vec<Filter>,
    pub costs: Vec<Cost>,
}

/// Goes through all days of `series`; with `onsets` ramps are followed.
pub(super) fn pass(series: &[Series], spread: &Spread, onsets: bool) -> Pass {
    let mut filters = vec![Filter::new(spread, onsets); series.len()];
    let mut costs = vec![Cost::default(); series.len()];
    let mut places = vec![0_usize; series.len()];
    let mut today = Vec::with_capacity(series.len());
    loop {
        let waiting = series
            .iter()
            .zip(&places)
            .filter_map(|(own, place)| own.days.get(*place));
        let Some(day) = waiting.map(|own| own.day).min() else {
            return Pass { filters, costs };
        };
        today.clear();
        for (i, (own, place)) in series.iter().zip(&mut places).enumerate() {
            if let Some(observation) = own.days.get(*place).filter(|own| own.day == day) {
                today.push((i, *observation));
                *place += 1;
            }
        }
        step(&mut filters, series, spread, &today, |i, u, variance| {
            costs[i].count(u, variance)
        });
        for (own, filter) in series.iter().zip(&mut filters) {
            if own.restarts.contains(&day) {
                filter.restart();
            }
        }
    }
}

/// A day: what each says beyond what was expected, less what all do together, is learnt.
/// `note` gets place, standardized innovation and its variance.
pub(super) fn step(
    filters: &mut [Filter],
    series: &[Series],
    spread: &Spread,
    today: &[(usize, Observation)],
    mut note: impl FnMut(usize, f64, f64),
) {
    let mut innovations = Vec::with_capacity(today.len());
    for (place, own) in today {
        let filter = &mut filters[*place];
        filter.predict(own.day, spread);
        innovations.push(filter.innovation(own, spread));
    }
    let siblings = today.iter().zip(&innovations);
    let siblings = siblings.filter(|((place, own), _)| !series[*place].is_named(own.day, NAMED));
    let siblings: Vec<(f64, f64)> = siblings
        .map(|(_, own)| (own.residual, own.variance))
        .collect();
    if siblings.len() < LEAST_SIBLINGS {
        return;
    }
    let Some((value, variance)) = location(&siblings) else {
        return;
    };
    let common = Common { value, variance };
    for (place, own) in today {
        if let Some((u, variance)) = filters[*place].update(own, common, spread) {
            note(*place, u.clamp(-10.0 * BOUND, 10.0 * BOUND), variance);
        }
    }
}
