//! Where the model's error is large: the residual over each signal, and the
//! windows of time with the largest errors.

use serde::Serialize;

use crate::numerics::statistics::quantile_or_zero;
use crate::signals::Signals;

/// Bins of a map.
const BINS: usize = 24;
/// Length of a window \[s\].
const WINDOW: f64 = 1.0;
/// Windows reported.
const MAX_WINDOWS: usize = 8;

/// Residual over one signal.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ResidualMap {
    /// `velocity`, `position`, `load`, `temperature`, `time`, `acceleration`, `date`, or an extra
    /// signal; of a contact as [`JointType::signal`](crate::JointType::signal) calls them.
    pub signal: String,
    /// Unit of the signal.
    pub unit: String,
    /// Bins in order; empty bins are left out.
    pub bins: Vec<Bin>,
}

/// Residual in one bin.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bin {
    /// Middle of the bin.
    pub at: f64,
    /// Mean residual \[Nm\].
    pub mean: f64,
    /// Standard deviation of the residual \[Nm\].
    pub spread: f64,
    /// Rows in it.
    pub count: usize,
}

/// A stretch of time with a large error.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Window {
    /// Name of the session.
    pub session: String,
    /// Start in it \[s\].
    pub from: f64,
    /// End in it \[s\].
    pub to: f64,
    /// RMS residual \[Nm\].
    pub rms: f64,
}

/// Rows of one session with their residual.
pub struct Residual<'a> {
    /// The session.
    pub signals: &'a Signals,
    /// Working samples.
    pub rows: &'a [usize],
    /// Residual of each row \[Nm\].
    pub values: Vec<f64>,
}

/// Maps over all recorded and derived signals.
#[must_use]
pub fn maps(residuals: &[Residual<'_>], facts: &crate::effects::Facts) -> Vec<ResidualMap> {
    let joint = facts.joint;
    let angle = crate::effects::ANGLE.of(joint);
    let named = |signal: &str, unit: &str, value: fn(&Signals, usize) -> f64| {
        map(residuals, joint.signal(signal), unit, value)
    };
    let mut maps = vec![
        named("velocity", &format!("{angle}/s"), |s, at| {
            s.points[at].velocity
        }),
        named("position", angle, |s, at| s.points[at].position),
        named("acceleration", &format!("{angle}/s²"), |s, at| {
            s.points[at].acceleration
        }),
        named("time", "s", Signals::time),
    ];
    if facts.loaded {
        maps.push(named("load", joint.force_unit(), |s, at| s.points[at].load));
    }
    if facts.days > 0.5 {
        maps.push(named("date", "d", |s, at| s.points[at].days));
    }
    if facts.temperature {
        maps.push(map(residuals, "temperature", "degC", |s, at| {
            s.points[at].temperature + facts.reference_temperature
        }));
    }
    let names: Vec<String> = residuals
        .first()
        .map(|r| r.signals.extra.keys().cloned().collect())
        .unwrap_or_default();
    for name in names {
        maps.push(map(residuals, &name, "", |s, at| {
            s.extra
                .get(&name)
                .and_then(|x| x.get(at))
                .copied()
                .unwrap_or(0.0)
        }));
    }
    maps
}

fn map(
    residuals: &[Residual<'_>],
    signal: &str,
    unit: &str,
    value: impl Fn(&Signals, usize) -> f64,
) -> ResidualMap {
    let pairs: Vec<(f64, f64)> = residuals
        .iter()
        .flat_map(|r| {
            r.rows
                .iter()
                .zip(&r.values)
                .map(|(at, e)| (value(r.signals, *at), *e))
        })
        .collect();
    let mut xs: Vec<f64> = pairs.iter().map(|p| p.0).collect();
    let low = quantile_or_zero(&mut xs, 0.002);
    let high = quantile_or_zero(&mut xs, 0.998);
    let mut sums = vec![(0_usize, 0.0, 0.0); BINS];
    for (x, e) in pairs {
        let bin =
            ((x - low) / (high - low).max(1e-300) * BINS as f64).clamp(0.0, BINS as f64 - 1.0);
        let (count, sum, square) = &mut sums[bin as usize];
        *count += 1;
        *sum += e;
        *square += e * e;
    }
    let bins = sums
        .iter()
        .enumerate()
        .filter(|(_, s)| s.0 > 0)
        .map(|(i, (count, sum, square))| {
            let n = *count as f64;
            let mean = sum / n;
            Bin {
                at: low + (high - low) * (i as f64 + 0.5) / BINS as f64,
                mean,
                spread: (square / n - mean * mean).max(0.0).sqrt(),
                count: *count,
            }
        })
        .collect();
    ResidualMap {
        signal: signal.to_owned(),
        unit: unit.to_owned(),
        bins,
    }
}

/// The windows with the largest errors, worst first.
#[must_use]
pub fn worst(residuals: &[Residual<'_>]) -> Vec<Window> {
    let mut windows = Vec::new();
    for residual in residuals {
        let mut sums: Vec<(usize, f64)> = Vec::new();
        for (at, e) in residual.rows.iter().zip(&residual.values) {
            let window = (residual.signals.time(*at) / WINDOW) as usize;
            if sums.len() <= window {
                sums.resize(window + 1, (0, 0.0));
            }
            sums[window].0 += 1;
            sums[window].1 += e * e;
        }
        windows.extend(
            sums.iter()
                .enumerate()
                .filter(|(_, s)| s.0 > 2)
                .map(|(i, (n, square))| Window {
                    session: residual.signals.name.clone(),
                    from: i as f64 * WINDOW,
                    to: (i + 1) as f64 * WINDOW,
                    rms: (square / *n as f64).sqrt(),
                }),
        );
    }
    windows.sort_by(|a, b| b.rms.total_cmp(&a.rms));
    windows.truncate(MAX_WINDOWS);
    windows
}
