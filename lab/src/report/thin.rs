//! Thins long curves out, keeping their peaks.

use serde::Serialize;

use super::{Report, Shade, Trace};

/// A curve keeps at most that many values; a screen has fewer columns.
pub(super) const MAX_POINTS: usize = 20_000;

/// A report with its curves as points.
#[derive(Debug, Serialize)]
pub(super) struct Thinned {
    #[serde(flatten)]
    report: Report,
    plots: Vec<Plot>,
}

/// One session's curves.
#[derive(Debug, Serialize)]
struct Plot {
    title: String,
    unit: String,
    curves: Vec<Points>,
    shades: Vec<Shade>,
}

/// A curve as points.
#[derive(Debug, Serialize)]
pub(super) struct Points {
    name: String,
    /// Time \[s\].
    pub(super) x: Vec<f64>,
    /// What is not finite becomes null, a hole.
    pub(super) y: Vec<f64>,
}

pub(super) fn thinned(report: &Report) -> Thinned {
    Thinned {
        plots: report.traces.iter().map(plot).collect(),
        report: Report {
            traces: Vec::new(),
            ..report.clone()
        },
    }
}

fn plot(trace: &Trace) -> Plot {
    Plot {
        title: trace.title.clone(),
        unit: trace.unit.clone(),
        shades: trace.shades.clone(),
        curves: trace
            .curves
            .iter()
            .map(|curve| points(&curve.name, trace.start, trace.period, &curve.values))
            .collect(),
    }
}

pub(super) fn points(name: &str, start: f64, period: f64, values: &[f64]) -> Points {
    let mut kept: Vec<usize> = Vec::new();
    if values.len() <= MAX_POINTS {
        kept.extend(0..values.len());
    } else {
        // Two of every stretch, the smallest and the largest, in their order.
        let stretch = values.len().div_ceil(MAX_POINTS / 2);
        for first in (0..values.len()).step_by(stretch) {
            let range = first..(first + stretch).min(values.len());
            let value = |index: &usize| values.get(*index).copied().unwrap_or(f64::NAN);
            let by_value = |a: &usize, b: &usize| value(a).total_cmp(&value(b));
            let least = range.clone().min_by(by_value).unwrap_or(first);
            let most = range.max_by(by_value).unwrap_or(first);
            kept.push(least.min(most));
            if least != most {
                kept.push(least.max(most));
            }
        }
    }
    let y = kept
        .iter()
        .map(|&index| short(values.get(index).copied().unwrap_or(f64::NAN)));
    Points {
        name: name.to_owned(),
        y: y.collect(),
        x: kept
            .iter()
            .map(|&index| micro(start + index as f64 * period))
            .collect(),
    }
}

/// Six digits: more cannot be seen.
fn short(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

/// To the microsecond.
fn micro(time: f64) -> f64 {
    (time * 1e6).round() / 1e6
}
