//! How far robots differ from one another and from day to day, found from all of them.

use super::filter::BOUND;
use super::group::pass;
use super::location::middle;
use super::series::Series;

/// Most robots that a fit looks at: an even choice of all.
const MOST_MEMBERS: usize = 32;
/// The share of robots with the worst fit that is left out: those that age differently.
const TRIMMED: f64 = 0.05;
/// Steps by which each variance is tried larger and smaller, one sweep after the other.
const FIRST_STEPS: [f64; 6] = [16.0, 16.0, 4.0, 4.0, 2.0, 1.4];
const STEPS: [f64; 3] = [3.0, 1.7, 1.3];
/// Steps of one variance in one direction within a sweep.
const MOST_STEPS: usize = 4;

/// Variances, as shares of the siblings' size: between robots and from day to day.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Of the noise, over the square of the standard error that the twin tells.
    pub noise: f64,
    /// Of what fades within days.
    pub wander: f64,
    /// Of the random walk \[1/d\].
    pub walk: f64,
    /// Between the robots' drifts \[1/d²\].
    pub drift: f64,
    /// Between the robots' slopes with temperature \[1/(10 K)²\].
    pub slope: f64,
    /// Between their curvatures \[1/(10 K)⁴\].
    pub curvature: f64,
    /// Mean slope \[1/(10 K)\] and mean curvature \[1/(10 K)²\].
    pub mean_slope: f64,
    /// See [`Spread::mean_slope`].
    pub mean_curvature: f64,
    /// The usual standard error.
    pub usual_error: f64,
    /// What is known of a robot's noise from its siblings', in degrees of freedom.
    pub alike: f64,
}

/// A variance that is fitted: where it is held while little is known (standard deviation),
/// by how much its logarithm may be off that (standard deviation), and its largest value.
struct Held {
    value: f64,
    by: f64,
    most: f64,
}

/// In the order of [`Spread::variance`]. Where they are held is what is published of gears:
/// slopes of some percent a kelvin that differ by a part of themselves, ageing of 10 % a year.
const HELD: [Held; 6] = [
    Held {
        value: 0.0,
        by: f64::INFINITY,
        most: f64::INFINITY,
    },
    Held {
        value: 0.003,
        by: 2.0,
        most: 0.1,
    },
    Held {
        value: 0.001,
        by: 1.5,
        most: 0.006,
    },
    Held {
        value: 3e-4,
        by: 1.0,
        most: 1e-3,
    },
    Held {
        value: 0.05,
        by: 2.0,
        most: 0.5,
    },
    Held {
        value: 0.01,
        by: 2.0,
        most: 0.2,
    },
];

impl Spread {
    /// What is believed before anything is seen, where the twins tell that standard error.
    pub(super) fn before(usual_error: f64) -> Spread {
        let square = |i: usize| HELD[i].value * HELD[i].value;
        Spread {
            noise: 1.0,
            wander: square(1),
            walk: square(2),
            drift: square(3),
            slope: square(4),
            curvature: square(5),
            mean_slope: 0.0,
            mean_curvature: 0.0,
            usual_error: usual_error.max(1e-6),
            alike: 10.0,
        }
    }

    /// Variance of the noise of a value with that standard error. One that is told far
    /// too small is not believed.
    pub(super) fn noise_of(&self, std_error: f64) -> f64 {
        self.noise * std_error.max(0.5 * self.usual_error).powi(2)
    }

    fn variance(&mut self, i: usize) -> &mut f64 {
        match i {
            0 => &mut self.noise,
            1 => &mut self.wander,
            2 => &mut self.walk,
            3 => &mut self.drift,
            4 => &mut self.slope,
            _ => &mut self.curvature,
        }
    }

    /// Makes a variance larger or smaller, within what is possible.
    fn multiply(&mut self, i: usize, factor: f64) {
        let most = HELD[i].most * HELD[i].most;
        let variance = self.variance(i);
        *variance = (*variance * factor).min(most).max(1e-14);
        // Few days cannot tell noise from what fades within days.
        let least = 0.25 * self.wander / (self.usual_error * self.usual_error);
        self.noise = self.noise.max(least);
    }

    /// How little it is believed, as a negative log-likelihood.
    fn doubt(mut self) -> f64 {
        let own = HELD
            .iter()
            .enumerate()
            .filter(|(_, held)| held.by.is_finite());
        own.map(|(i, held)| {
            let off = (*self.variance(i) / (held.value * held.value)).ln() / held.by;
            0.5 * off * off
        })
        .sum()
    }
}

/// The spread of `series`, beginning with `before`; `first` where that is a mere belief.
pub(super) fn fit(series: &[Series], before: &Spread, first: bool) -> Spread {
    let told: Vec<Series> = series
        .iter()
        .filter(|own| own.days.len() > 1)
        .cloned()
        .collect();
    let stride = told.len().div_ceil(MOST_MEMBERS).max(1);
    let members: Vec<Series> = told.into_iter().step_by(stride).collect();
    if members.len() < 3 {
        return *before;
    }
    let mut spread = *before;
    let errors = members
        .iter()
        .flat_map(|own| own.days.iter().map(|day| day.std_error));
    spread.usual_error = middle(errors).unwrap_or(0.0).max(1e-6);
    let steps: &[f64] = if first { &FIRST_STEPS } else { &STEPS };
    let mut best = judge(&members, &mut spread, true);
    for step in steps {
        for i in 0..HELD.len() {
            for factor in [*step, 1.0 / step] {
                let mut improved = false;
                for _ in 0..MOST_STEPS {
                    let mut trial = spread;
                    trial.multiply(i, factor);
                    let cost = judge(&members, &mut trial, false);
                    if cost >= best - 1e-6 {
                        break;
                    }
                    (best, spread, improved) = (cost, trial, true);
                }
                if improved {
                    break;
                }
            }
        }
        best = judge(&members, &mut spread, true);
    }
    settle(&members, &mut spread);
    spread
}

/// The negative log-likelihood of `spread`, without the robots that fit worst; with
/// `means` the mean slope and curvature are led on to what was learnt.
fn judge(members: &[Series], spread: &mut Spread, means: bool) -> f64 {
    let passed = pass(members, spread, false);
    let kept = kept(&passed.costs);
    if means {
        // Every robot's own slope, without the pull of the prior: (m − b) / k of precision k / D.
        for i in 0..2 {
            let learnt = kept
                .iter()
                .map(|own| passed.filters[*own].learnt(spread)[i]);
            let (sum, weight) = learnt.fold((0.0, 0.0), |(s, w), (m, k)| (s + m, w + k.max(0.0)));
            let change = if weight > 0.3 { sum / weight } else { 0.0 };
            match i {
                0 => spread.mean_slope += change,
                _ => spread.mean_curvature += change,
            }
        }
        return judge(members, spread, false);
    }
    let costs = kept.iter().map(|own| passed.costs[*own].cost);
    costs.sum::<f64>() + spread.doubt()
}

/// Members without those that fit worst.
fn kept(costs: &[Cost]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..costs.len()).collect();
    let mean = |own: usize| costs[own].cost / costs[own].values.max(1.0);
    order.sort_by(|a, b| mean(*a).total_cmp(&mean(*b)));
    let left_out = (TRIMMED * costs.len() as f64).ceil() as usize;
    order.truncate(costs.len() - left_out);
    order.sort_unstable();
    order
}

/// The noise so that bounded innovations have the variance of bounded normal ones, and
/// how alike the robots' noise is.
fn settle(members: &[Series], spread: &mut Spread) {
    // Mean of min(u², 9), u normal.
    const EXPECTED: f64 = 0.9874;
    for _ in 0..2 {
        let passed = pass(members, spread, false);
        let kept = kept(&passed.costs);
        let of = |what: fn(&Cost) -> f64| {
            kept.iter()
                .map(|own| what(&passed.costs[*own]))
                .sum::<f64>()
        };
        let values = of(|own| own.values);
        if values < 20.0 {
            return;
        }
        let share = (of(|own| own.bounded) / values / EXPECTED).clamp(0.3, 3.0);
        spread.noise *= share;
        spread.wander *= share;
        spread.walk *= share;
    }
    let passed = pass(members, spread, false);
    let scales: Vec<(f64, f64)> = passed
        .filters
        .iter()
        .filter_map(|own| own.own_scale())
        .collect();
    if scales.len() < 10 {
        return;
    }
    // A robot's own mean of n halved squared differences varies by 3/n (they overlap); what
    // is beyond that is how the robots differ, and 2/freedom is the variance of a
    // chi-square's share.
    let n = scales.len() as f64;
    let mean = scales.iter().map(|(own, _)| own).sum::<f64>() / n;
    let varies = scales
        .iter()
        .map(|(own, _)| (own / mean - 1.0).powi(2))
        .sum::<f64>()
        / (n - 1.0);
    let by_chance = scales.iter().map(|(_, count)| 3.0 / count).sum::<f64>() / n;
    spread.alike = (2.0 / (varies - by_chance).max(0.03)).clamp(6.0, 60.0);
}

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
