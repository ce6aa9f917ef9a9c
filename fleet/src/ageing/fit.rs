//! The spread that explains all series best.

use super::location::middle;
use super::pass::{Cost, pass};
use super::series::Series;
use super::spread::Spread;

/// Most robots that a fit looks at: an even choice of all.
const MOST_MEMBERS: usize = 32;
/// The share of robots with the worst fit that is left out: those that age differently.
const TRIMMED: f64 = 0.05;
/// Steps by which each variance is tried larger and smaller, one sweep after the other.
const FIRST_STEPS: [f64; 6] = [16.0, 16.0, 4.0, 4.0, 2.0, 1.4];
const STEPS: [f64; 3] = [3.0, 1.7, 1.3];
/// Steps of one variance in one direction within a sweep.
const MOST_STEPS: usize = 4;

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
        for i in 0..Spread::VARIANCES {
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
