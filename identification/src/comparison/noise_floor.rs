//! Noise of the recordings, below which no model can reduce the error.

use std::collections::HashMap;

use serde::Serialize;

use crate::design::{Design, PreparedModel};
use crate::validation::left_out::LeftOut;

/// Smallest time \[s\] between two passes that are repeats.
const MIN_TIME_APART: f64 = 1.0;
/// Smallest number of pairs for an estimate.
const MIN_PAIRS: usize = 40;

/// Noise within sessions and variation between them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NoiseFloor {
    /// RMS \[Nm\] between passes at the same position, velocity and load within
    /// a session; `None` where nothing was repeated.
    pub repeats: Option<f64>,
    /// Pairs of rows that were compared.
    pub pairs: usize,
    /// RMS \[Nm\] due to the variation of parameters from session to session; `None`
    /// for a single session.
    pub sessions: Option<f64>,
}

/// Compares the residual (each session with its own parameters) of rows in the
/// same cell of position, direction, speed, load and acceleration, where rows count
/// for errors. What varies between sessions is what these err by, left out in turn, beyond what
/// they err by with parameters of their own: recordings that are held out have no part in it.
#[must_use]
pub fn find(prepared: &PreparedModel, design: &Design) -> NoiseFloor {
    let travel = prepared.facts.travel().max(1e-300);
    let speed = prepared.facts.speed[1].max(1e-300);
    let mut loads: Vec<f64> = Vec::new();
    let mut accelerations: Vec<f64> = Vec::new();
    for s in &prepared.sessions {
        for at in &s.rows {
            loads.push(s.points[*at].load.abs());
            accelerations.push(s.points[*at].acceleration.abs());
        }
    }
    let top_load = crate::numerics::statistics::quantile_or_zero(&mut loads, 0.98).max(1e-300);
    let top_acceleration =
        crate::numerics::statistics::quantile_or_zero(&mut accelerations, 0.98).max(1e-300);
    let (mut sum, mut pairs, mut square, mut rows) = (0.0, 0_usize, 0.0, 0_usize);
    for (session, signals) in design.sessions.iter().zip(&prepared.sessions) {
        let residual = session.own_residual();
        let mut last: HashMap<[i32; 5], (f64, f64)> = HashMap::new();
        let each = residual.iter().zip(&signals.rows).zip(&session.judged);
        for ((r, at), _) in each.filter(|(_, judged)| **judged) {
            square += r * r;
            rows += 1;
            let point = &signals.points[*at];
            let bin = |x: f64, scale: f64, count: f64| {
                (x / scale * count).floor().clamp(-1e6, 1e6) as i32
            };
            let key = [
                bin(point.position, travel, 60.0),
                point.sign() as i32,
                bin(point.velocity.abs().sqrt(), speed.sqrt(), 12.0),
                bin(point.load, top_load, 12.0),
                bin(point.acceleration, top_acceleration, 5.0),
            ];
            let time = signals.time(*at);
            match last.get(&key) {
                Some((before, value)) if time - before > MIN_TIME_APART => {
                    sum += 0.5 * (r - value).powi(2);
                    pairs += 1;
                    last.insert(key, (time, *r));
                }
                Some(_) => {}
                None => {
                    last.insert(key, (time, *r));
                }
            }
        }
    }
    let within = square / rows.max(1) as f64;
    NoiseFloor {
        repeats: (pairs >= MIN_PAIRS).then(|| (sum / pairs as f64).sqrt()),
        pairs,
        sessions: (design.sessions.len() > 1).then(|| {
            let left_out = LeftOut::of_folds(design).rms();
            (left_out * left_out - within).max(0.0).sqrt()
        }),
    }
}
